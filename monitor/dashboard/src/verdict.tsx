// Did it pass, or how does it stand, and how real was its time: what the scenario expects, with value and band.
import { useEffect } from "preact/hooks";
import { connected, run, verdict, type Expectation, type Standing, type Verdict } from "./model";
import { brief, time } from "./text";

/** Asks again until the run is judged: a recording is judged already, a live run when it has ended. */
export function useVerdict(): void {
  const known = verdict.value?.judged ?? false, here = connected.value;
  useEffect(() => {
    if (!here || known) return;
    const get = () => fetch("/api/v1/verdict").then(r => (r.ok ? r.json() : null)).then((v: Verdict | null) => { if (v) verdict.value = v; }).catch(() => {});
    get();
    const timer = setInterval(get, 1000);
    return () => clearInterval(timer);
  }, [here, known]);
}

const failed = (e: Expectation) => (e.pass === false || e.standing === "failed") && !e.advisory;
const order = (e: Expectation, judged: boolean) => (failed(e) ? 0 : judged ? (e.pass === false ? 1 : e.pass ? 2 : 3) : ["failed", "not_yet", "holds", "passed", "unknown", "shown"].indexOf(e.standing ?? "unknown") + 1);

const said: Record<Standing, { text: string; look: string; title: string }> = {
  unknown: { text: "… not yet known", look: "soft", title: "its time has not begun, or what it waits for has not come" },
  holds: { text: "✓ holds so far", look: "soft", title: "the value is in the accepted band and may leave it yet" },
  not_yet: { text: "… not yet", look: "soft", title: "the value is outside of the accepted band and may come into it yet" },
  passed: { text: "✓ pass", look: "good", title: "whatever comes" },
  failed: { text: "✕ failed for good", look: "bad", title: "whatever comes" },
  shown: { text: "shown", look: "soft", title: "it is not judged" },
};

function Mark({ e, judged }: { e: Expectation; judged: boolean }) {
  if (!judged) {
    const s = e.standing === null ? null : said[e.standing];
    return s === null ? <span class="soft">…</span> : <span class={s.look === "bad" && e.advisory ? "warn" : s.look} title={s.title}>{s.text}</span>;
  }
  if (e.pass === null) return <span class="soft">shown</span>;
  return e.pass ? <span class="good">✓ pass</span> : e.advisory ? <span class="warn">▲ advisory</span> : <span class="bad">✕ fail</span>;
}

/** A condition holds or does not; everything else has a value. */
const value = (e: Expectation) => (e.value === null ? "–" : /^(always|never|eventually) /.test(e.rule) ? (e.value ? "holds" : "does not hold") : `${Number(e.value.toPrecision(6))}${e.unit ? " " + e.unit : ""}`);

function headline(v: Verdict): { text: string; look: string } {
  const bad = v.expectations.filter(failed).length, all = v.expectations.length;
  if (!v.judged && v.reached_s === undefined) return { text: `${all} expectation${all === 1 ? "" : "s"}, judged when the run has ended`, look: "" };
  if (!v.judged) {
    const known = v.expectations.filter(e => e.standing === "holds" || e.standing === "passed").length;
    return bad ? { text: `✕ ${bad} of ${all} expectations failed already`, look: "bad" } : { text: `${known} of ${all} expectations hold so far, none has failed`, look: "" };
  }
  if (bad) return { text: `✕ ${bad} of ${all} expectations failed`, look: "bad" };
  if (v.exit && v.exit !== 1) return { text: `✕ ${v.cause || `exit code ${v.exit}`}`, look: "bad" };
  return { text: "✓ every expectation holds", look: "good" };
}

/** "lockstep, as fast as it goes: 8 s in 15.3 s (x0.52)", "real time: 12 ticks were late" */
function pace(v: Verdict): { text: string; look: string } {
  const r = run.value;
  if (!r) return { text: "", look: "" };
  const past = v.simulated_s !== undefined && v.wall_s ? `: ${time(v.simulated_s, v.simulated_s)} in ${brief(v.wall_s)} s, x${brief(v.simulated_s / v.wall_s)}` : r.factor > 0 ? `: now x${brief(r.factor)}` : "";
  if (r.mode === "lockstep") return { text: `Lockstep, results do not depend on the speed${past}`, look: "" };
  if (v.overruns === undefined) return { text: `Real time${past}`, look: "" };
  return v.overruns ? { text: `▲ Real time: ${v.overruns.toLocaleString("en")} ticks were late${past}`, look: "warn" } : { text: `✓ Real time: no tick was late${past}`, look: "good" };
}

export function VerdictView() {
  const v = verdict.value;
  if (!v) return null;
  const said = headline(v), speed = pace(v);
  return (
    <>
      <p class={`verdict ${said.look}`} role="status">{said.text}</p>
      <p class={`pace ${speed.look}`}>{speed.text}</p>
      {!v.judged && v.reached_s !== undefined && <p class="pace">By what is recorded up to {time(v.reached_s, run.value?.duration_s || v.reached_s)}. The report says the last word.</p>}
      <div class="scroll" tabindex={0} aria-label="expectations, with value and band">
        <table class="plain">
          <thead><tr><th /><th>expectation</th><th class="number">value</th><th class="number">accepted</th></tr></thead>
          <tbody>
            {[...v.expectations].sort((a, b) => order(a, v.judged) - order(b, v.judged)).map(e => (
              <tr key={e.name} title={`${e.rule}${e.detail ? `\n${e.detail}` : ""}`}>
                <td class="sign"><Mark e={e} judged={v.judged} /></td>
                <td>{e.name.replace(/_/g, "_\u200b")}{failed(e) && e.detail && <div class="soft">{e.detail}</div>}</td>
                <td class={`number ${failed(e) ? "bad" : ""}`}>{value(e)}</td>
                <td class="number soft">{e.accepted || "–"}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </>
  );
}
