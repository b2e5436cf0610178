// Numbers for people: three digits, the prefix that fits, the unit always there.
const prefixes: [number, string][] = [[1, ""], [1e-3, "m"], [1e-6, "µ"], [1e-9, "n"]];

export function withUnit(value: number, unit: string, digits = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (unit === "") return String(Math.round(value * 1000) / 1000);
  if (unit === "rad") return `${((value * 180) / Math.PI).toPrecision(digits)}°`;
  const size = Math.abs(value) < 1e-12 ? 0 : Math.abs(value); // rounding is not shown as if it were something
  const usable = unit.includes("/") || unit === "deg" ? prefixes.slice(0, 1) : prefixes;
  const [scale, prefix] = usable.find(([s]) => size >= s * 0.9995) ?? (size === 0 ? usable[0] : usable[usable.length - 1]);
  const shown = size === 0 ? 0 : value / scale;
  const text = Math.abs(shown) >= 1000 ? String(Math.round(shown)) : Number(shown.toPrecision(digits)).toString();
  return `${text.replace("-", "−")} ${prefix}${unit}`;
}

/** Which prefix suits a whole axis, as a factor and the unit to write. */
export function axisUnit(largest: number, unit: string): [number, string] {
  if (unit === "" || unit.includes("/") || largest === 0) return [1, unit];
  if (unit === "rad") return [180 / Math.PI, "°"];
  const [scale, prefix] = prefixes.find(([s]) => largest >= s * 0.5) ?? prefixes[2];
  return [1 / scale, prefix + unit];
}
