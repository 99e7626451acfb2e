# SPDX-License-Identifier: BSD-3-Clause
"""Names of peers as text has them."""

PEERS = {"cgal": "CGAL (cutoff 10)", "cgal-1000": "CGAL (cutoff 1000)", "fcl-tree": "FCL's tree", "embree": "Embree",
         "bullet-dbvt": "Bullet's `btDbvt`", "physx-abp": "PhysX's ABP"}


def called(names):
    """ "CGAL (cutoff 10), Embree and FCL's tree", each once; what has no name in text bears its own."""
    texts = [PEERS.get(name, f"`{name}`") for name in dict.fromkeys(names)]
    return ", ".join(texts[:-1]) + " and " * (len(texts) > 1) + texts[-1]
