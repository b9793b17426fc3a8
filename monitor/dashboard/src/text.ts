// Numbers and times for people.
export const fixed = (v: number | undefined, digits: number) => (v === undefined ? "–" : v.toFixed(digits));

export function compact(v: number): string {
  const a = Math.abs(v);
  if (!isFinite(v)) return String(v);
  if (a !== 0 && (a < 1e-3 || a >= 1e6)) return v.toExponential(3);
  return v.toPrecision(5).replace(/\.?0+$/, "");
}

/** 3.29, 11.5: three digits say what a measurement of this machine is worth. */
export const brief = (v: number) => (v !== 0 && (Math.abs(v) < 1e-3 || Math.abs(v) >= 1e4) ? compact(v) : String(Number(v.toPrecision(3))));

/** With so many decimals that they tell a thousandth of what is shown, and the same of all that stand together. */
export function within(v: number, span: number): string {
  if (!isFinite(v)) return String(v);
  const told = span > 0 ? Math.floor(3.3 - Math.log10(span)) : 3, small = Math.abs(v) < 100 && span < 5000;
  const digits = Math.max(told, small ? 1 : 0); // a load current matters beside a fault current, too
  if (digits > 7 || Math.abs(v) >= 1e7) return compact(v);
  const text = v.toFixed(digits);
  return Number(text) === 0 ? text.replace("-", "") : text;
}

/** 2 h 05 min, 6.20 s: with as many digits as the whole length deserves. */
export function time(s: number, whole: number): string {
  if (whole >= 7200) {
    const minutes = Math.floor(s / 60);
    return `${Math.floor(minutes / 60)} h ${String(minutes % 60).padStart(2, "0")} min`;
  }
  return whole >= 100 ? `${s.toFixed(1)} s` : `${s.toFixed(3)} s`;
}

/** For an axis and for events: 5.5131 s, or 4:12 h. */
export function stamp(s: number, whole: number): string {
  if (whole < 7200) return s.toFixed(whole < 100 ? 4 : 1);
  const seconds = Math.round(s);
  const two = (n: number) => String(n).padStart(2, "0");
  return `${Math.floor(seconds / 3600)}:${two(Math.floor(seconds / 60) % 60)}:${two(seconds % 60)}`;
}

export const rate = (v: number) => (v === 0 ? "0" : v >= 100 ? Math.round(v).toLocaleString("en") : v >= 10 ? v.toFixed(1) : v.toFixed(2)) + " /s";

/** "bus.*.v_pu" against "bus.B1.v_pu"; * stands for anything. */
export function matches(pattern: string, name: string): boolean {
  const escaped = pattern.replace(/[.+?^${}()|[\]\\]/g, "\\$&").replace(/\*/g, ".*");
  return new RegExp(`^${escaped}$`).test(name);
}
