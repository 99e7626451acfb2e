# SPDX-License-Identifier: BSD-3-Clause
"""One script for each record that has to be computed with, or judged, before it can be drawn.

What is drawn as it is has been declared in the record's definition, and drawn by plots/draw. `plots/script` names them
all; `plots/script cost-model RECORD` calls one. Hypotheses and laws stand here; nothing of bvlab_plots knows of them.
"""
