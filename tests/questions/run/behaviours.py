count = 0


def go():
    return "Trans_Z", 400


def spin():
    return "Rotn_Y", 45


def bad(ranges):
    raise ValueError("no echo in beam 3")


def sometimes(ranges):
    global count
    count += 1
    if count % 7 == 3:
        return {}["beam"]
    return min(ranges)


def wrong(ranges):
    return "Trans_Q", 3


def two():
    return {"Trans_Z": 100, "Rotn_Y": 20}


def grab():
    return "Grasp", 40


def look(near):
    return ("Rotn_Y", 30) if near < 900 else None


def halt():
    raise ValueError("no plan")
