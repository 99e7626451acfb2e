# SPDX-License-Identifier: BSD-3-Clause


class Refused(Exception):
    """What cannot be drawn, in one line that says what there is instead; `key` is that of the figure where it is one's."""

    def __init__(self, text, key=""):
        super().__init__(text)
        self.key = key
