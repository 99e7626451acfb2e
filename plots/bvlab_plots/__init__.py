# SPDX-License-Identifier: BSD-3-Clause
"""Records in, figures out: the library behind plots/draw, plots/compare, plots/report and bvlab.record.

    import sys; sys.path.insert(0, "plots")     # not needed where `import bvlab` works
    from bvlab_plots import records
    frame = records.read("experiments/record/nine-bunnies")     # a pandas frame, see records.read

records     a record as a frame of pandas              figures    the [[figure]] tables of a definition
points      what is drawn of a frame: numbers          kinds      the kinds of figures, and what draws each
style       one look for a name, for good              draw, compare, report    the commands
"""
