// What sort of event something was; its shape and colour follow from it.
import { network, type RunEvent } from "./model";

export type Kind = "fault" | "act" | "alarm" | "lost" | "note";

export function kindOf(e: RunEvent): Kind {
  const what = e.event === "event" ? e.text : e.event; // of the timeline: the text is its name
  if (e.event === "fault" || (e.event === "event" && network.value?.faults?.some(f => f.name === e.text))) return "fault";
  if (/alarm|\.begins$/.test(what)) return "alarm";
  if (/lost|killed|died|failed|stall|^exit$/.test(what) || / killed$/.test(e.text)) return "lost";
  return /trip|command|open|close|pickup/.test(what) ? "act" : "note";
}
