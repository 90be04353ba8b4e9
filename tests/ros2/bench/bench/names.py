SPACE = "/space"
FAR = SPACE + "/far"
PARTS = {"arm": 1, "leg": 2}


class Near:
    HAND: str = "hand"
