#!/usr/bin/env python3
"""Reads what `tactum export` and `tactum report` make of a recording:  exports.py TACTUM

The numbers of the HDF5 file, read with h5py and put into a frame of pandas, are those of the CSV file to the bit (which
mcap_core.mjs compares with @mcap/core), every column says its unit, axes and meaning, and the numbers of the report are
computed again from the table. Ends with 77 where h5py or pandas is not installed.
"""
import json
import math
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import h5py
    import numpy
    import pandas
except ImportError as missing:
    print(f"skipped: {missing}")
    sys.exit(77)

TACTUM = sys.argv[1]
FRAMES = 1200


def demand(holds, what):
    if not holds:
        sys.exit(f"wrong: {what}")


def tactum(*words, code=0):
    run = subprocess.run([TACTUM, *map(str, words)], capture_output=True, text=True, check=False)
    demand(run.returncode in (code if isinstance(code, tuple) else (code,)), f"tactum {words} ended with {run.returncode}: {run.stderr}")
    return run


def record(path, scene):
    tactum("feel", scene, "--virtual-clock", "--updates", FRAMES, "--record", path, code=(0, 2))


def same_bits(a, b):
    return numpy.array_equal(numpy.asarray(a, dtype=float).view(numpy.int64), numpy.asarray(b, dtype=float).view(numpy.int64))


def check_hdf5(folder):
    table = pandas.read_csv(folder / "run.csv", comment="#", float_precision="round_trip")
    with h5py.File(folder / "run.h5") as file:
        names = [name.decode() if isinstance(name, bytes) else name for name in file["frame"].attrs["columns"]]
        demand(names == list(table.columns), "the columns are not those of the table")
        frames = pandas.DataFrame({name: file["frame"][name][:] for name in names})
        demand(frames.shape == (FRAMES, len(names)), f"the shape is {frames.shape}")
        for name in names:
            demand(same_bits(frames[name], table[name]), f"{name} has other bits than the table")
        for group in ("frame", "input", "contacts"):
            for name, column in file[group].items():
                demand({"unit", "axes", "meaning"} <= set(column.attrs), f"{group}/{name} is not described")
        for name, unit, axes in (("sent_fx_N", "N", "W"), ("hand_wz_rad_per_s", "rad/s", "W"), ("device_px_m", "m", "D"),
                                 ("energy_balance_J", "J", "none"), ("momentum_off_Ns", "N s", "none"), ("hand_qw", "1", "W"),
                                 ("work_dropped_error", "m", "none"), ("restoring_tx_Nm", "N m", "W"), ("flags", "1", "none")):
            attributes = file["frame"][name].attrs
            demand((attributes["unit"], attributes["axes"]) == (unit, axes), f"{name}: {attributes['unit']}, {attributes['axes']}")
        demand(list(file["input"]["index"][:]) == list(range(FRAMES)), "the frames have other numbers")
        demand(numpy.allclose(file["input"]["p_DH_m"][:, 2], table["device_pz_m"], rtol=0, atol=1e-12), "the samples are not those of the table")
        demand(file.attrs["scene"] == "block-on-plate" and file.attrs["rate_Hz"] == 1000, "the run is described wrongly")
        demand(file["settings"].attrs["coupling.stiffness_N_per_m"] > 0, "the settings are missing")
        demand("schema = 1" in file["files"]["scene.toml"][()].decode(), "the scene is missing")
        contacts = {name: column[:] for name, column in file["contacts"].items()}
    demand(len(contacts["frame"]) > 100 and contacts["frame"].max() < FRAMES, "there are no contacts")
    demand(numpy.allclose(numpy.linalg.norm(contacts["n_BA_W"], axis=1), 1.0), "normals are no unit vectors")
    pushing = numpy.unique(contacts["frame"][contacts["force_N"] > 0])
    demand(set(pushing) <= set(table.index[table["contact_points"] > 0]), "contacts stand at frames without any")
    return table, contacts


def check_two_hands(folder):
    """A second hand has columns of its own, and a group with what came from its device."""
    record(folder / "hands.mcap", "peg-two-hands")
    tactum("replay", folder / "hands.mcap", "--verify")
    tactum("export", folder / "hands.mcap", "--csv", folder / "hands.csv", "--hdf5", folder / "hands.h5")
    table = pandas.read_csv(folder / "hands.csv", comment="#", float_precision="round_trip")
    with h5py.File(folder / "hands.h5") as file:
        demand(len(file["frame"]) == table.shape[1] and len(table) == FRAMES, "the columns are not those of the table")
        for name in table.columns:
            demand(same_bits(file["frame"][name][:], table[name]), f"{name} has other bits than the table")
        for name, unit, axes in (("h2_sent_fx_N", "N", "W"), ("h2_device_px_m", "m", "D"), ("h2_energy_stored_J", "J", "none"),
                                 ("h2_hand_wz_rad_per_s", "rad/s", "W"), ("h2_safety", "1", "none")):
            attributes = file["frame"][name].attrs
            demand((attributes["unit"], attributes["axes"]) == (unit, axes), f"{name}: {attributes['unit']}, {attributes['axes']}")
        samples = file["hand_2"]["p_DH_m"][:]
        demand(file["hand_2"].attrs["device"] == file.attrs["device"], "the second device is not named")
        demand(all({"unit", "axes", "meaning"} <= set(column.attrs) for column in file["hand_2"].values()), "a column is not described")
    demand(numpy.allclose(samples[:, 2], table["h2_device_pz_m"], rtol=0, atol=1e-12), "the samples are not those of the table")
    demand(norms(table, "h2_sent_f", "N").max() > 0.1, "the second hand feels nothing")
    apart = numpy.sqrt(sum((table[f"hand_p{a}_m"] - table[f"h2_hand_p{a}_m"]).to_numpy() ** 2 for a in "xyz"))
    demand(apart.min() > 0.005, "the hands are one")


def norms(table, quantity, unit, axes="xyz"):
    return numpy.sqrt(sum(table[f"{quantity}{axis}_{unit}"].to_numpy() ** 2 for axis in axes))


def expected_numbers(table, contacts):
    stages = sum(table[name].to_numpy() for name in table.columns if name.startswith("stage_"))
    withheld = numpy.sqrt(sum((table[f"passive_f{a}_N"] - table[f"sent_f{a}_N"]).to_numpy() ** 2 for a in "xyz"))
    stretch = numpy.sqrt(sum((table[f"hand_p{a}_m"] - table[f"proxy_p{a}_m"]).to_numpy() ** 2 for a in "xyz"))
    stretch = stretch[table["grasped_body"].to_numpy() >= 0]
    last = table.iloc[-1]
    return {
        "frames": FRAMES, "duration_s": FRAMES / 1000, "rate_Hz": 1000, "dropped_frames": 0,
        "largest_sent_force_N": norms(table, "sent_f", "N").max(), "mean_sent_force_N": norms(table, "sent_f", "N").mean(),
        "largest_sent_torque_Nm": norms(table, "sent_t", "Nm").max(), "mean_sent_torque_Nm": norms(table, "sent_t", "Nm").mean(),
        "largest_stretch_m": stretch.max(), "mean_stretch_m": stretch.mean(),
        "contact_frames": (table["grasped_contact_points"] > 0).sum(), "penetrating_frames": (table["penetrating"] > 0).sum(),
        "contact_points": len(contacts["frame"]), "largest_contact_force_N": contacts["force_N"].max(),
        "energy_from_hand_J": last["energy_total_from_hand_J"], "energy_to_hand_J": last["energy_total_to_hand_J"],
        "energy_generated_J": last["energy_generated_J"], "least_energy_balance_J": table["energy_balance_J"].min(),
        "least_stiffness_share": min(1.0, table["energy_stiffness_share"].min()),
        "mean_frame_time_s": stages.mean(), "largest_frame_time_s": stages.max(),
        "safety_frames": (table["safety"] != 0).sum(), "largest_withheld_force_N": withheld.max(),
    }


def numbers_in(page):
    return json.loads(re.search(r'<script type="application/json" id="numbers">(.*?)</script>', page, re.DOTALL).group(1))


def check_report(folder, table, contacts):
    page = (folder / "run.html").read_text(encoding="utf-8")
    numbers, = numbers_in(page)
    for key, value in expected_numbers(table, contacts).items():
        demand(math.isclose(numbers[key], value, rel_tol=1e-9, abs_tol=1e-18), f"{key} is {numbers[key]} in the report and {value}")
    cells = re.findall(r'<td data-key="(\w+)" data-value="([^"]+)">([^<]+)</td>', page)
    demand(len(cells) == len(numbers) - 2, f"{len(cells)} numbers are shown of {len(numbers) - 2}")
    for key, value, shown in cells:
        demand(float(value) == numbers[key], f"{key} is shown as {value}")
        scale = {"mN": 1e3, "mm": 1e3, "um": 1e6, "mJ": 1e3, "us": 1e6, "%": 100}.get((shown.split() + [""])[1], 1)
        demand(math.isclose(float(shown.split()[0]), float(value) * scale, rel_tol=1e-5), f"{key}: {shown} is not {value}")
    demand(page.count("<svg") >= 18 and "nothing of this" not in page.split("Latency")[0], "charts are missing")
    demand(not re.search(r"https?://|<link|<img|\bsrc=|@import|url\(", page), "the page asks for something of the network")
    shares = re.findall(r"<tr><td>starting</td><td>(\d+)</td>", page)
    starting = (table["safety"].astype(int) & 16 != 0).sum()
    demand(shares == [str(starting)], f"the start ramp has {shares} frames, not {starting}")


def check_comparison(folder):
    record(folder / "other.mcap", "peg-1mm")
    tactum("report", "--compare", folder / "run.mcap", folder / "other.mcap", "-o", folder / "both.html")
    page = (folder / "both.html").read_text(encoding="utf-8")
    one, other = numbers_in(page)
    demand(one["scene"] == "block-on-plate" and other["scene"] == "peg-1mm", "the runs are not both there")
    demand(page.count("<svg") == 2 * page.count('class="pair"'), "charts do not stand in pairs")
    axes = re.findall(r'<div class="pair">.*?</div>', page, re.DOTALL)[0].split("<figure>")[1:]
    ticks = [re.findall(r'class="tick"[^>]*>([^<]*)<', figure) for figure in axes]
    demand(ticks[0] == ticks[1] and len(ticks[0]) > 4, f"the axes differ: {ticks}")


def check_cut(folder):
    whole = (folder / "run.mcap").read_bytes()
    (folder / "cut.mcap").write_bytes(whole[: len(whole) * 6 // 10])
    tactum("report", folder / "cut.mcap", "-o", folder / "cut.html")
    demand("has no end" in (folder / "cut.html").read_text(encoding="utf-8"), "the report hides that the recording was cut")
    tactum("export", folder / "cut.mcap", "--hdf5", folder / "cut.h5")
    with h5py.File(folder / "cut.h5") as file:
        rows = {len(column) for column in file["frame"].values()}
        demand(len(rows) == 1 and 0 < rows.pop() < FRAMES, "the columns of a cut recording have different lengths")
    (folder / "bad.mcap").write_bytes(b"no recording")
    for words in (("report", folder / "bad.mcap", "-o", folder / "bad.html"), ("export", folder / "bad.mcap", "--hdf5", folder / "bad.h5")):
        demand("bad.mcap" in tactum(*words, code=1).stderr, "the bad file is not named")
    demand(not (folder / "bad.h5").exists() and not (folder / "bad.h5.unfinished").exists(), "a failed export leaves a file")
    demand(tactum("export", folder / "run.mcap", "--hdf5", "/nowhere/run.h5", code=1).stderr.count("/nowhere/run.h5") == 1, "no sentence")
    demand("--compare" in tactum("report", folder / "run.mcap", folder / "cut.mcap", code=1).stderr, "two files without --compare")


def check_full_disk(folder):
    """A file that may grow no further is told by a sentence, and nothing is left."""
    run = subprocess.run(["sh", "-c", f"trap '' XFSZ; ulimit -f 100; exec '{TACTUM}' export '{folder}/run.mcap' --hdf5 '{folder}/full.h5'"],
                         capture_output=True, text=True, check=False)
    demand(run.returncode == 1 and "cannot write the whole file" in run.stderr, f"a full disk: {run.returncode}, {run.stderr}")
    demand(not list(folder.glob("full.h5*")), "a file without its end is left")


def main():
    with tempfile.TemporaryDirectory(prefix="tactum-exports-") as name:
        folder = pathlib.Path(name)
        record(folder / "run.mcap", "block-on-plate")
        tactum("export", folder / "run.mcap", "--csv", folder / "run.csv", "--hdf5", folder / "run.h5")
        tactum("export", folder / "run.mcap", "--hdf5", folder / "again.h5")
        demand((folder / "run.h5").read_bytes() == (folder / "again.h5").read_bytes(), "two exports have other bytes")
        tactum("report", folder / "run.mcap", "-o", folder / "run.html")
        table, contacts = check_hdf5(folder)
        check_report(folder, table, contacts)
        check_comparison(folder)
        check_cut(folder)
        check_two_hands(folder)
        check_full_disk(folder)
    print(f"{FRAMES} frames of {table.shape[1]} columns and {len(contacts['frame'])} contacts are the same")


main()
