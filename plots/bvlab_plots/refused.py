# SPDX-License-Identifier: BSD-3-Clause


class Refused(Exception):
    """What cannot be drawn, in one line that says what there is instead."""
