#!/usr/bin/env python3
"""Writes the seeds of the fuzzers' corpora:  fuzz/make_corpus.py [TACTUM]

Small files of every format, sound and broken, made here. With the program given, the seeds of part files and
recordings too are made anew, by `tactum prepare` and `tactum feel --record`.
"""
import pathlib
import struct
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).parent / "corpus"
ENDINGS = ("obj", "stl", "ply", "off", "gltf", "glb", "dae")  # the first byte of a seed is the number of its ending
CORNERS = [(x, y, z) for z in (0, 1) for y in (0, 1) for x in (0, 1)]
FACES = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
TRIANGLES = [(f[0], f[i], f[i + 1]) for f in FACES for i in (1, 2)]


def obj():
    lines = ["# a cube", "o cube"] + ["v %g %g %g" % c for c in CORNERS]
    yield "\n".join(lines + ["f " + " ".join(str(i + 1) for i in f) for f in FACES])
    yield "\n".join(lines + ["f " + " ".join("%d//1" % (i - 8) for i in f) for f in FACES])
    yield "v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\ng a\nf 1 2 3 4\ng b\nf 1 2 \\\n 3\np 1\nl 1 2\n"
    yield "v 1 2\nf 1 2 3\n"
    yield b"\xef\xbb\xbfv 0 0 0\nlod 1 2\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"


def stl():
    text = ["solid cube"]
    binary = b""
    for t in TRIANGLES:
        points = [CORNERS[i] for i in t]
        text += ["facet normal 0 0 0", "outer loop"] + ["vertex %g %g %g" % p for p in points] + ["endloop", "endfacet"]
        binary += struct.pack("<12fH", 0, 0, 0, *(c for p in points for c in p), 0)
    yield "\n".join(text + ["endsolid cube"])
    yield b"\0" * 80 + struct.pack("<I", len(TRIANGLES)) + binary
    yield "\n".join(text + ["END SOLID cube"]).upper().replace("ENDLOOP", "END LOOP").replace("0 0", "0D+0 0")
    yield b"ten million triangles".ljust(80) + struct.pack("<I", 10_000_000) + binary  # and twelve are there


def ply():
    head = "ply\nformat %s 1.0\nelement vertex 8\nproperty float x\nproperty float y\nproperty double z\n"
    head += "element face 6\nproperty list uchar int vertex_indices\nend_header\n"
    rows = ["%g %g %g" % c for c in CORNERS] + ["4 " + " ".join(map(str, f)) for f in FACES]
    yield (head % "ascii") + "\n".join(rows) + "\n"
    for name, order in (("binary_little_endian", "<"), ("binary_big_endian", ">")):
        data = b"".join(struct.pack(order + "ffd", *c) for c in CORNERS)
        data += b"".join(struct.pack(order + "B4i", 4, *f) for f in FACES)
        yield (head % name).encode() + data
    yield (head % "ascii").replace("face 6", "face 4000000000")
    strips = head.replace("face 6", "tristrips 1").replace("uchar int", "int int")
    yield (strips % "ascii") + "\n".join(rows[:8]).replace(" ", "\n") + "\n10 0 2 1 3 3 -1 4 5\n6 7\n"
    data = b"".join(struct.pack("<ffd", *c) for c in CORNERS) + struct.pack("<11i", 10, 0, 2, 1, 3, 3, -1, 4, 5, 6, 7)
    yield (strips % "binary_little_endian").replace("\n", "\r").encode() + data


def off():
    yield "OFF\n8 6 0\n" + "\n".join("%g %g %g" % c for c in CORNERS) + "\n" + "\n".join("4 %d %d %d %d" % f for f in FACES)
    yield "OFF 3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
    yield "# glued\nSTCNOFF3 1\n0 0 0 0 0 1 9 9 9 9 0 0\n1 0 0 # short\n0\n1 0\n3 0 1 2 255 0 0\n"
    yield "3\n1\n0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"


def gltf():
    uri = "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"
    yield ('{"asset":{"version":"2.0"},"buffers":[{"byteLength":36,"uri":"%s"}],"bufferViews":[{"buffer":0,'
           '"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],'
           '"max":[1,1,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0}],'
           '"scenes":[{"nodes":[0]}],"scene":0}' % uri)
    words = "data:application/octet-stream;base64,AAABAAIAAwAAAAAAAAD/fwAAAAD/f/9//38="
    yield ('{"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"buffers":[{"byteLength":26,'
           '"uri":"%s"}],"bufferViews":[{"buffer":0,"byteLength":8},{"buffer":0,"byteOffset":8,"byteLength":18}],'
           '"accessors":[{"componentType":5122,"normalized":true,"count":4,"type":"VEC3","sparse":{"count":3,"indices":'
           '{"bufferView":0,"byteOffset":2,"componentType":5123},"values":{"bufferView":1}}},{"bufferView":0,'
           '"componentType":5123,"count":4,"type":"SCALAR"}],"meshes":[{"primitives":[{"attributes":{"POSITION":0},'
           '"indices":1,"mode":5},{"attributes":{"POSITION":0},"mode":6}]}],"nodes":[{"mesh":0}]}' % words)
    yield '{"asset":{"version":"2.0"},"nodes":[{"children":[0]}],"scenes":[{"nodes":[0]}]}'


def prepare():
    box = bytes(16 * c for p in CORNERS for c in p)
    faces = bytes(i for t in TRIANGLES for i in t)
    yield bytes([5, 0]) + box + faces                     # a cube
    yield bytes([5, 4]) + box + faces[:-6]                # without a side, to be closed
    yield bytes([5, 0]) + box + faces[:18] + faces[:9] + faces[9:]  # sides that stand twice
    yield bytes([13, 6]) + box + bytes(8 * c + 4 for p in CORNERS for c in p) + faces + bytes(i + 8 for i in faces)


def scene():
    body = '[[body]]\nname = "a"\npart = { box = { size_m = [0.1, 0.1, 0.1] } }\ndensity_kg_per_m3 = 1200\n'
    yield "schema = 1\n" + body + '[tool]\nbody = "a"\n[settings]\nresponse = "penalty"\n'
    yield 'schema = 1\n' + body + body + 'joint = { kind = "hinge", axis = [0, 0, nan] }\n'
    yield "body:\n  - name: a\n"
    yield b"\xef\xbb\xbfschema = 1e999\n[[friction]]\nbetween = [1, \"\\u00e9\"]\n"


def collada():
    geometry = ('<asset><unit meter="0.01"/><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh><source id="s">'
                '<float_array id="a">0 0 0 3 0 0 0 2 0 0 0 1</float_array><technique_common><accessor source="#a" count="4" '
                'stride="3"/></technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>'
                '<%s><input semantic="VERTEX" source="#v" offset="0"/>%s</%s></mesh></geometry></library_geometries>')
    scene = ('<library_visual_scenes><visual_scene id="w"><node id="n"><rotate>0 0 1 90</rotate><scale>-1 1 2</scale>%s</node>'
             '</visual_scene></library_visual_scenes><scene><instance_visual_scene url="#w"/></scene></COLLADA>')
    shown = scene % '<instance_geometry url="#g"/>'
    head = '<?xml version="1.0"?><COLLADA version="1.4.1">'
    yield head + geometry % ("triangles", "<p>0 2 1 0 1 3 0 3 2 1 2 3</p>", "triangles") + shown
    yield head + geometry % ("polylist", "<vcount>3 4</vcount><p>0 2 1 0 1 3 2</p>", "polylist") + shown
    yield head + geometry % ("tristrips", "<p>0 2 1 3 0 2</p>", "tristrips") + shown
    yield head + geometry % ("trifans", "<p>0 2 1 3 9</p>", "trifans") + shown
    yield head + geometry % ("polygons", "<p>0 2 1</p>", "polygons") + scene % '<instance_node url="#n"/>'


def robots():
    yield ('<mujoco><compiler angle="radian" eulerseq="zYx" settotalmass="2"/><default><geom size="0.1 0.2"/>'
           '<default class="a"><joint type="slide" range="0 1"/></default></default><worldbody><body pos="0 0 1" '
           'euler="1 2 3" childclass="a"><joint/><geom type="capsule" fromto="0 0 0 1 0 0"/><body><joint type="ball" '
           'range="0 1"/><inertial mass="1" pos="0 0 0" diaginertia="1 1 1"/></body></body></worldbody></mujoco>')
    yield ('<robot name="r"><link name="a"><collision><geometry><box size="1 1 1"/></geometry></collision></link>'
           '<link name="b"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>'
           '<joint type="revolute"><parent link="a"/><child link="b"/><origin xyz="1 0 0" rpy="0 1 0"/>'
           '<limit lower="0.1" upper="1"/><dynamics damping="1"/></joint></robot>')
    yield '<mujoco><include file="fuzzed.xml"/><worldbody><geom type="plane" size="0 0 1"/></worldbody></mujoco>'
    yield "<robot><robot></robot>"


def recordings(whole):
    """A recording, the same cut and with other bytes, and what stands behind its checksums: a head."""
    yield whole
    for part in (1, 3, 5, 7):
        yield whole[:len(whole) * part // 8]
    for place in (9, 40, len(whole) // 2, len(whole) - 20):
        yield whole[:place] + bytes([whole[place] ^ 0x41]) + whole[place + 1:]
    yield whole[:9] + b"\xff" * 8 + whole[17:]  # a length beyond all memory
    yield whole + b"more"
    yield b'{"format":1,"tactum":"0.1.0","compiler":"","date":"","scene":"a","scene_file":"","grip":"","dt_s":"inf"}'
    yield b'{"format":2}'


def write(folder, name, data, first=b""):
    (ROOT / folder).mkdir(parents=True, exist_ok=True)
    (ROOT / folder / (name + ".bin")).write_bytes(first + (data.encode() if isinstance(data, str) else data))


def main(arguments):
    for ending, make in (("obj", obj), ("stl", stl), ("ply", ply), ("off", off), ("gltf", gltf), ("dae", collada)):
        for i, data in enumerate(make()):
            write("mesh", "seed-%s-%d" % (ending, i), data, bytes([ENDINGS.index(ending)]))
    for i, data in enumerate(prepare()):
        write("prepare", "seed-%d" % i, data)
    for i, data in enumerate(scene()):
        write("scene", "seed-%d" % i, data)
    for i, data in enumerate(robots()):
        write("import", "seed-%d" % i, data)
    if not arguments:
        return
    tetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n"
    with tempfile.TemporaryDirectory() as folder:
        for name, mesh in (("solid", tetrahedron), ("surface", tetrahedron[:-8])):
            source = pathlib.Path(folder) / (name + ".obj")
            source.write_text(mesh)
            part = ROOT / "part" / ("seed-" + name + ".bin")
            part.parent.mkdir(parents=True, exist_ok=True)
            subprocess.run([arguments[0], "prepare", source, "-o", part, "--no-cache"], check=True)
        recording = pathlib.Path(folder) / "run.mcap"
        subprocess.run([arguments[0], "feel", "block-on-plate", "--virtual-clock", "--updates", "3", "--record", recording],
                       stdout=subprocess.DEVNULL)  # its goals are not met in three frames
        for i, data in enumerate(recordings(recording.read_bytes())):
            write("recording", "seed-%02d" % i, data)


if __name__ == "__main__":
    main(sys.argv[1:])
