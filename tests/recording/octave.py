#!/usr/bin/env python3
"""Reads the HDF5 file of a recording with Octave:  octave.py TACTUM

Every column of /frame, as Octave loads it, has the numbers of the CSV file to the bit, and the columns of /input and
/contacts have the shapes and types that docs/recording.md tells. Ends with 77 where octave-cli is not installed.
"""
import array
import pathlib
import shutil
import subprocess
import sys
import tempfile

FRAMES = 900
SCRIPT = """
run = load("run.h5", "frame", "input", "contacts");
out = fopen("columns.bin", "wb");
names = fieldnames(run.frame);
for i = 1:numel(names)
  fwrite(out, run.frame.(names{i}), "double");
end
fclose(out);
printf("%s\\n", names{:});
printf("\\n%d %d %s\\n", size(run.input.p_DH_m), class(run.input.p_DH_m));
printf("%d %s\\n", numel(run.input.index), class(run.input.index));
printf("%d %s\\n", numel(run.contacts.body_a), class(run.contacts.body_a));
"""


def demand(holds, what):
    if not holds:
        sys.exit(f"wrong: {what}")


def run(words, folder, codes=(0,)):
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=folder)
    demand(done.returncode in codes, f"{words} ended with {done.returncode}: {done.stdout}{done.stderr}")
    return done


def main():
    octave = shutil.which("octave-cli")
    if octave is None:
        print("octave-cli is not installed")
        return 77
    tactum = str(pathlib.Path(sys.argv[1]).resolve())
    with tempfile.TemporaryDirectory(prefix="tactum-octave-") as name:
        folder = pathlib.Path(name)
        run([tactum, "feel", "block-on-plate", "--virtual-clock", "--updates", str(FRAMES), "--record", "run.mcap"], folder, (0, 2))
        run([tactum, "export", "run.mcap", "--hdf5", "run.h5", "--csv", "run.csv"], folder)
        (folder / "read.m").write_text(SCRIPT)
        names, rest = run([octave, "--no-init-file", "read.m"], folder).stdout.split("\n\n")
        names = names.split()
        numbers = array.array("d")
        numbers.frombytes((folder / "columns.bin").read_bytes())
        lines = [line for line in (folder / "run.csv").read_text().splitlines() if not line.startswith("#")]
    header, rows = lines[0].split(","), [[float(number) for number in line.split(",")] for line in lines[1:]]
    demand(len(rows) == FRAMES and sorted(names) == sorted(header), "Octave finds other columns than the table has")
    for place, column in enumerate(names):
        expected = array.array("d", (row[header.index(column)] for row in rows))
        found = numbers[place * FRAMES:(place + 1) * FRAMES]
        demand(found.tobytes() == expected.tobytes(), f"{column} has other bits in Octave than in the table")
    samples, index, contacts = rest.split("\n")[:3]
    demand(samples == f"3 {FRAMES} double", f"the samples are {samples}")
    demand(index == f"{FRAMES} uint64", f"the numbers of the frames are {index}")
    demand(contacts.endswith(" int32") and int(contacts.split()[0]) > 0, f"the contacts are {contacts}")
    print(f"{len(names)} columns of {FRAMES} frames are the same to the bit in Octave")
    return 0


sys.exit(main())
