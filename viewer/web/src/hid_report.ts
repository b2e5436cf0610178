// The axes and buttons in the reports of a six-axis device, found from its report descriptor as the browser has parsed it.
// Models differ in how they spread the axes over reports, so no offset is known beforehand: each field lies where the
// fields before it end.

/** What WebHID tells of a field: `count` numbers of `size` bits on end. Usages are page << 16 | usage. */
export interface HidItem {
  reportSize?: number; reportCount?: number; logicalMinimum?: number; logicalMaximum?: number;
  isConstant?: boolean; isArray?: boolean; isRange?: boolean; usages?: number[]; usageMinimum?: number; usageMaximum?: number;
}
export interface HidCollection { inputReports?: { reportId?: number; items?: HidItem[] }[]; children?: HidCollection[] }

const firstAxis = 0x10030; // Generic Desktop: X, Y, Z, Rx, Ry, Rz
const axes = 6;
const buttonPage = 0x9;

interface Field { axis: number; button: number; bit: number; size: number; low: number; high: number }

/** The usage of each number of an item; 0 where it has none. */
function usagesOf(item: HidItem, count: number): number[] {
  return Array.from({ length: count }, (_, i) => {
    if (item.isRange) return Math.min((item.usageMinimum ?? 0) + i, item.usageMaximum ?? 0);
    const usages = item.usages ?? [];
    return usages[Math.min(i, usages.length - 1)] ?? 0; // the last usage holds for all that follow
  });
}

/** An unsigned number of so many bits, the lowest first, or null where the report is too short. */
function bitsAt(data: DataView, bit: number, size: number): number | null {
  if (bit + size > 8 * data.byteLength) return null;
  let value = 0;
  for (let i = 0; i < size; ++i) {
    const at = bit + i;
    value += ((data.getUint8(at >> 3) >> (at & 7)) & 1) * 2 ** i;
  }
  return value;
}

/** Reports with axes at this level, or where the browser lists them only deeper, there. */
function reportsWithAxes(collection: HidCollection): { reportId?: number; items?: HidItem[] }[] {
  const own = collection.inputReports ?? [];
  const hasAxes = own.some((report) => (report.items ?? []).some((item) =>
    usagesOf(item, item.reportCount ?? 0).some((usage) => usage >= firstAxis && usage < firstAxis + axes)));
  return hasAxes ? own : [...own, ...(collection.children ?? []).flatMap(reportsWithAxes)];
}

export class SixAxisReports {
  /** Full deflections are -1 and 1: X, Y, Z, Rx, Ry, Rz. What no report has told is 0. */
  readonly values = [0, 0, 0, 0, 0, 0];
  buttons = 0;
  private readonly fields = new Map<number, Field[]>();

  constructor(collections: readonly HidCollection[]) {
    const ends = new Map<number, number>();
    for (const report of collections.flatMap(reportsWithAxes)) {
      const id = report.reportId ?? 0;
      const fields = this.fields.get(id) ?? [];
      let bit = ends.get(id) ?? 0;
      for (const item of report.items ?? []) {
        const [size, count] = [item.reportSize ?? 0, item.reportCount ?? 0];
        const usages = item.isConstant || item.isArray ? [] : usagesOf(item, count);
        usages.forEach((usage, i) => {
          const axis = usage - firstAxis;
          const button = usage >>> 16 === buttonPage ? (usage & 0xffff) - 1 : -1;
          if ((axis >= 0 && axis < axes) || (button >= 0 && button < 31))
            fields.push({ axis: axis >= 0 && axis < axes ? axis : -1, button, bit: bit + i * size, size, low: item.logicalMinimum ?? 0, high: item.logicalMaximum ?? 0 });
        });
        bit += size * count;
      }
      ends.set(id, bit);
      this.fields.set(id, fields);
    }
  }

  /** Whether the descriptor has all six axes. */
  get complete(): boolean {
    const found = new Set([...this.fields.values()].flat().map((field) => field.axis));
    return [0, 1, 2, 3, 4, 5].every((axis) => found.has(axis));
  }

  /** Takes a report, without its number; a report that the descriptor does not know changes nothing. */
  take(reportId: number, data: DataView) {
    for (const field of this.fields.get(reportId) ?? []) {
      const raw = bitsAt(data, field.bit, field.size);
      if (raw === null) continue;
      if (field.axis >= 0) {
        const value = field.low < 0 && raw >= 2 ** (field.size - 1) ? raw - 2 ** field.size : raw;
        const full = Math.max(Math.abs(field.low), Math.abs(field.high));
        this.values[field.axis] = full > 0 ? Math.min(1, Math.max(-1, value / full)) : 0;
      } else {
        this.buttons = raw ? this.buttons | (1 << field.button) : this.buttons & ~(1 << field.button);
      }
    }
  }
}
