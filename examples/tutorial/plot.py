"""Reads run.csv, prints what slides how, and draws force over time and over position into force.svg."""
import csv

with open("run.csv") as file:
    lines = (line for line in file if not line.startswith("#"))
    rows = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(lines)]

sliding = [row for row in rows if row["friction_slipping"] > 0]
ratios = [-row["sent_fx_N"] / row["sent_fz_N"] for row in sliding]
pressed = max(row["sent_fz_N"] for row in rows)
print(f"{len(rows)} frames, {len(sliding)} of them sliding")
print(f"largest force upward {pressed:.2f} N")
print(f"force along x over force upward while it slides: {sorted(ratios)[len(ratios) // 2]:.3f}")


def curve(x_name, y_name, top, colour):
    """One quantity over another, in a field of 600 x 150 points, from its least to its largest value."""
    xs, ys = [row[x_name] for row in rows], [row[y_name] for row in rows]
    points = " ".join(f"{60 + 600 * (x - min(xs)) / (max(xs) - min(xs)):.1f},"
                      f"{top + 150 - 150 * (y - min(ys)) / (max(ys) - min(ys)):.1f}" for x, y in zip(xs, ys))
    caption = f"{y_name} from {min(ys):.3f} to {max(ys):.3f}, over {x_name} from {min(xs):.3f} to {max(xs):.3f}"
    return (f'<text x="60" y="{top - 8}" font-family="sans-serif" font-size="13" fill="#444">{caption}</text>'
            f'<rect x="60" y="{top}" width="600" height="150" fill="none" stroke="#bbb"/>'
            f'<polyline points="{points}" fill="none" stroke="{colour}" stroke-width="1.5"/>\n')


with open("force.svg", "w") as file:
    file.write('<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 720 600"><rect width="720" height="600" fill="#fff"/>\n')
    file.write(curve("time_s", "sent_fz_N", 40, "#1f77b4"))
    file.write(curve("time_s", "sent_fx_N", 230, "#d62728"))
    file.write(curve("proxy_px_m", "sent_fx_N", 420, "#2ca02c"))
    file.write("</svg>\n")
