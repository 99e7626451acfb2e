# SPDX-License-Identifier: BSD-3-Clause
"""Names of volumes and peers as text has them."""

VOLUMES = {"sphere": "spheres", "obb": "oriented boxes", "aabb": "boxes along the axes", "rss": "rectangle swept spheres",
           "shell": "shells"}
PEERS = {"cgal": "CGAL (cutoff 10)", "cgal-1000": "CGAL (cutoff 1000)", "fcl-tree": "FCL's tree", "embree": "Embree",
         "bullet-dbvt": "Bullet's `btDbvt`"}


def called(names, of=VOLUMES):
    """ "spheres, rectangle swept spheres and 26-DOPs", each once; what has no name in text bears its own."""
    texts = [of.get(name, f"{name[4:]}-DOPs" if name.startswith("kdop") else f"`{name}`") for name in dict.fromkeys(names)]
    return ", ".join(texts[:-1]) + " and " * (len(texts) > 1) + texts[-1]
