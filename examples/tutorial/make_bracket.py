"""Writes bracket.stl: an angle bracket of 60 x 30 x 40 mm, in millimetres, with one triangle that faces inward."""

outline = [(0, 0), (60, 0), (60, 8), (8, 8), (8, 40), (0, 40)]  # x and z of the corners of one side
width = 30

triangles = []
for a, b, c in [(0, 1, 2), (0, 2, 3), (0, 3, 4), (0, 4, 5)]:  # the two sides
    triangles.append([(outline[i][0], 0, outline[i][1]) for i in (a, b, c)])
    triangles.append([(outline[i][0], width, outline[i][1]) for i in (a, c, b)])
for (x0, z0), (x1, z1) in zip(outline, outline[1:] + outline[:1]):  # the faces between them
    p, q, r, s = (x0, 0, z0), (x0, width, z0), (x1, width, z1), (x1, 0, z1)
    triangles += [[p, q, r], [p, r, s]]

triangles[8].reverse()  # the fault

with open("bracket.stl", "w") as file:
    file.write("solid bracket\n")
    for corners in triangles:
        file.write("facet normal 0 0 0\n outer loop\n")
        for x, y, z in corners:
            file.write(f"  vertex {x} {y} {z}\n")
        file.write(" endloop\nendfacet\n")
    file.write("endsolid bracket\n")
