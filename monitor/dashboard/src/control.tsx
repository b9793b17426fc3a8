// Run control: pause, step, continue, stop of a run that was started with --allow-control.
import { signal } from "@preact/signals";
import { run } from "./model";

const kKey = "gridspace control token";
const refused = signal("");

async function ask(action: string) {
  const token = sessionStorage.getItem(kKey) ?? prompt("Control token (in the file control.token of the run folder):")?.trim();
  if (!token) return;
  const answer = await fetch("/api/v1/control", {
    method: "POST", headers: { Authorization: `Bearer ${token}`, "Content-Type": "application/json" }, body: JSON.stringify({ action }),
  }).catch(() => null);
  refused.value = answer?.ok ? "" : answer ? ((await answer.json()).error ?? `${answer.status}`) : "no answer";
  if (answer?.ok) sessionStorage.setItem(kKey, token);
  else if (answer?.status === 401) sessionStorage.removeItem(kKey);
}

export function Control() {
  const lockstep = run.value?.mode === "lockstep", halted = run.value?.state === "paused";
  return (
    <div class="tools" role="group" aria-label="run control">
      {lockstep && (halted
        ? <><button onClick={() => ask("continue")}>▶ continue</button><button onClick={() => ask("step 1")}>▶| step</button></>
        : <button onClick={() => ask("pause")}>❚❚ pause</button>)}
      <button onClick={() => { if (confirm("End this run?")) void ask("stop"); }}>■ stop</button>
      {halted && <span class="pill">paused</span>}
      {refused.value && <span class="bad" role="alert">{refused.value}</span>}
    </div>
  );
}
