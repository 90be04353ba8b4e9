"""Each lint with its purpose and reason, a rule that it reports and a rule that it accepts."""

from typing import NamedTuple


class Page(NamedTuple):
    """The documentation of a lint; `bad` is reported, `good` is not. Both are whole files.

    `fixed` describes the text that `--fix` writes, if there is a safe fix.
    """

    code: str
    title: str
    what: str
    why: str
    bad: str
    good: str
    fixed: str = ""


_CITY = "%*! city(C: city)\nC is a city.\n*%\n#defined city/1.\n"
_ROAD = "%*! road(R: road, C: city, D: city, K: {paved, gravel})\nR leads from C to D.\n*%\n"
_ROAD += "#defined road/4.\n"
_LENGTH = "%*! lasts(R: road, T: milliseconds)\nR takes T.\n*%\n#defined lasts/2.\n"
_BEAT = "%*! beats(R: road, F: millihertz)\nA light on R blinks F times.\n*%\n#defined beats/2.\n"

PAGES = (
    Page(
        "rule-sort",
        "Arguments of the wrong sort",
        "Reports a variable that is two things at once, one that is negated or asked for as what "
        "it is not, and a comparison of values of two sorts. "
        "Sorts are declared in `%*! name(X: sort) *%`, and handed on from rule to rule.",
        "The two have no value in common, so the rule never fires. Often two arguments were "
        "swapped.",
        f"{_CITY}{_ROAD}near(C, D) :- road(C, D, _, _), city(C).\n#show near/2.\n",
        f"{_CITY}{_ROAD}near(C, D) :- road(_, C, D, _), city(C).\n#show near/2.\n",
    ),
    Page(
        "rule-unit",
        "Numbers in the wrong unit",
        "Reports a comparison, an aggregate, a sum or a variable with numbers of two units, and a "
        "number that is too small to be meant in its unit, such as `F < 25` where F is in "
        "millihertz.",
        "Rules count in small units, so that all numbers are whole. clingo compares any two "
        "numbers and does not notice.",
        f"{_ROAD}{_LENGTH}{_BEAT}odd(R) :- lasts(R, T), beats(R, F), T < F.\n#show odd/1.\n",
        f"{_ROAD}{_LENGTH}{_BEAT}odd(R) :- lasts(R, T), beats(R, F), T < 1000000 / F.\n"
        "#show odd/1.\n",
    ),
    Page(
        "rule-value",
        "A value that never occurs",
        "Reports a constant that an argument never has: it is not among those that are declared, "
        "or among those that the rules derive.",
        "It is usually misspelt. The premise never holds, and its negation always does.",
        f"{_ROAD}smooth(R) :- road(R, _, _, pavd).\n#show smooth/1.\n",
        f"{_ROAD}smooth(R) :- road(R, _, _, paved).\n#show smooth/1.\n",
        "the known constant, where only one is spelt nearly so",
    ),
    Page(
        "rule-form",
        "A string for a constant, or a constant for a string",
        "Reports a string where an argument holds constants or numbers, and the reverse.",
        '`paved` and `"paved"` are different values in clingo, so the premise never holds.',
        f'{_ROAD}smooth(R) :- road(R, _, _, "paved").\n#show smooth/1.\n',
        f"{_ROAD}smooth(R) :- road(R, _, _, paved).\n#show smooth/1.\n",
        "the same word with quotes, or without",
    ),
    Page(
        "rule-singleton",
        "A variable that occurs once",
        "Reports a variable that occurs once in a rule and in its metadata, unless its name "
        "begins with `_`; and a variable whose name begins with `_` but that occurs again.",
        "Such a variable matches any value. It is often a misspelling of another one.",
        f"{_ROAD}joined(C) :- road(R, C, D, _).\n#show joined/1.\n",
        f"{_ROAD}joined(C) :- road(_, C, _D, _).\n#show joined/1.\n",
    ),
    Page(
        "rule-contradiction",
        "A body that never holds",
        "Reports literals and comparisons that are never true together: `p(X), not p(X)`, "
        "`X < Y, Y < X`, `X = a, X = b`, `#count { ... } < 0`, and two facts where a `key` allows "
        "one.",
        "The rule never fires.",
        f"{_CITY}odd(C) :- city(C), not city(C).\n#show odd/1.\n",
        f"{_CITY}{_ROAD}odd(C) :- city(C), not road(_, C, _, _).\n#show odd/1.\n",
    ),
    Page(
        "rule-redundant",
        "A literal that changes nothing",
        "Reports a literal that is repeated, a comparison that holds anyway, an aggregate whose "
        "bound it always meets, and a rule that derives one of its own premises.",
        "It costs time and hides what was meant.",
        f"{_CITY}far(C) :- city(C), city(C).\n#show far/1.\n",
        f"{_CITY}far(C) :- city(C).\n#show far/1.\n",
        "the rule without the repeated literal or the comparison",
    ),
    Page(
        "rule-aggregate",
        "An aggregate that counts too little",
        "Reports a sum whose equal weights are added once, a count in which nothing varies, a "
        "variable of a tuple that is bound outside of the aggregate, and a choice in which nothing "
        "varies.",
        "An aggregate is over a set of tuples. Two elements with equal tuples count once, and a "
        "variable that the body binds has a single value in it.",
        f"{_ROAD}{_LENGTH}whole(N) :- N = #sum {{ T : lasts(R, T), road(R, _, _, _) }}.\n"
        "#show whole/1.\n",
        f"{_ROAD}{_LENGTH}whole(N) :- N = #sum {{ T, R : lasts(R, T), road(R, _, _, _) }}.\n"
        "#show whole/1.\n",
    ),
    Page(
        "rule-recursion",
        "Recursion without end",
        "Reports a term that grows with each turn of a recursive rule, such as `p(X + 1) :- p(X)` "
        "or `p(f(X)) :- p(X)`, where nothing bounds it.",
        "clingo grounds such a program without end.",
        "step(1).\nstep(N + 1) :- step(N).\n#show step/1.\n",
        "step(1).\nstep(N + 1) :- step(N), N < 10.\n#show step/1.\n",
    ),
    Page(
        "rule-negation",
        "A predicate that rests on its own negation",
        "Reports `not p` in the body of a rule from which p follows, directly or through others.",
        "What follows is then open, or nothing does. Findings must follow from the facts.",
        f"{_CITY}odd(C) :- city(C), not even(C).\neven(C) :- city(C), not odd(C).\n"
        "#show odd/1. #show even/1.\n",
        f"{_CITY}{_ROAD}odd(C) :- city(C), not even(C).\neven(C) :- road(_, C, _, _).\n"
        "#show odd/1. #show even/1.\n",
    ),
    Page(
        "rule-join",
        "Premises that share no variable",
        "Reports two premises over large predicates that no variable and no equation joins.",
        "Each instance of one is paired with each instance of the other, so the cost grows with "
        "the square.",
        f"{_CITY}pair(C, D) :- city(C), city(D), C < D.\n#show pair/2.\n",
        f"{_CITY}{_ROAD}pair(C, D) :- city(C), city(D), road(_, C, D, _).\n#show pair/2.\n",
    ),
    Page(
        "rule-unused",
        "A predicate that nothing reads",
        "Reports a predicate that is derived, or declared by `#defined`, but that no other rule "
        "reads but those it rests on itself, no `#show` names, and no cost rests on; and an "
        "attribute that no rule reads.",
        "It costs time, and often another name was meant.",
        f"{_CITY}large(C) :- city(C).\n",
        f"{_CITY}large(C) :- city(C).\n#show large/1.\n",
    ),
    Page(
        "rule-undefined",
        "A premise that nothing gives",
        "Reports a predicate that is declared by `#defined` without documentation, that no rule "
        "derives and only constraints read; and predicates that are derived from each other alone.",
        "The constraint never excludes anything, or always everything. What rests on itself alone "
        "never holds.",
        '#defined closed/1.\n:- closed(C), C != "Ulm".\n',
        f'{_CITY}closed(C) :- city(C).\n:- closed(C), C != "Ulm".\n',
    ),
    Page(
        "rule-duplicate",
        "The same rule again",
        "Reports a rule that is equal to another one but for the names of its variables and the "
        "order of its premises.",
        "One of the two was meant to be another rule.",
        f"{_ROAD}near(C, D) :- road(_, C, D, _).\nnear(X, Y) :- road(_, X, Y, _).\n#show near/2.\n",
        f"{_ROAD}near(C, D) :- road(_, C, D, _).\nnear(X, Y) :- road(_, Y, X, _).\n#show near/2.\n",
    ),
    Page(
        "rule-subsumed",
        "A rule that another one covers",
        "Reports a rule of which another rule with the same head asks for less. A rule with a "
        "message of its own is not reported.",
        "The rule derives nothing new: a premise is missing in the other one.",
        f"{_CITY}{_ROAD}near(C, D) :- road(_, C, D, _).\n"
        "near(C, D) :- road(_, C, D, paved), city(C).\n#show near/2.\n",
        f"{_CITY}{_ROAD}near(C, D) :- road(_, C, D, gravel).\n"
        "near(C, D) :- road(_, C, D, paved), city(C).\n#show near/2.\n",
    ),
    Page(
        "rule-message",
        "A message that depends on the derivation",
        "Reports a hole in the message of a finding whose value the head does not settle. "
        "`key: R` in the documentation of a predicate states that R settles its other arguments. "
        "Also reports two rules that may give one finding unlike messages.",
        "Where several derivations give one finding, only one of them is shown.",
        f"{_CITY}{_ROAD}%! because: `{{C}}` is joined to `{{D}}`\n"
        "finding(C) :- road(_, C, D, _).\n",
        f"{_CITY}{_ROAD}%! because: `{{C}}` is joined to `{{D}}`\n"
        "finding(C) :- city(C), D = #min { E : road(_, C, E, _) }.\n",
    ),
    Page(
        "rule-hole",
        "A hole that tells readers nothing",
        "Reports a hole `{T:millihertz}` whose variable is of another sort, a hole whose value is "
        "a number by which rules tell things apart, and a brace without its counterpart.",
        "The number would be shown in a unit in which it does not count, or is one that readers do "
        "not know.",
        f"{_LENGTH}%! because: some road takes {{T:millihertz}}\nfinding(R, T) :- lasts(R, T).\n",
        f"{_LENGTH}%! because: some road takes {{T:milliseconds}}\nfinding(R, T) :- lasts(R, T).\n",
    ),
    Page(
        "rule-example",
        "An example that is missing",
        "Reports a line `%! example:` that is not the path of a file, from the folder of the rule "
        "or one above it, or from the current one.",
        "Readers look for the case in which the rule fires.",
        f"{_CITY}%! because: `{{C}}` is large\n%! example: nowhere.lp\nfinding(C) :- city(C).\n",
        f"{_CITY}%! because: `{{C}}` is large\nfinding(C) :- city(C).\n",
    ),
    Page(
        "rule-arithmetic",
        "Arithmetic that may overflow",
        "Reports products of two variables, and sums of numbers that users state, unless "
        "comparisons with numbers keep them small enough. A line `%! fits: REASON` states why they "
        "fit otherwise.",
        "Integers have 32 bits, and clingo wraps what does not fit without a message.",
        f"{_LENGTH}long(R) :- lasts(R, T), lasts(_, U), T * U > 9.\n#show long/1.\n",
        f"{_LENGTH}long(R) :- lasts(R, T), T > 9000.\n#show long/1.\n",
    ),
    Page(
        "rule-name",
        "Two predicates of one name",
        "Reports a predicate with the name of another one that has more or fewer arguments.",
        "A reader takes one for the other, and a forgotten argument shows nowhere.",
        f"{_CITY}city(C, C) :- city(C).\n#show city/2.\n",
        f"{_CITY}large(C) :- city(C).\n#show large/1.\n",
    ),
    Page(
        "rule-none",
        "A word compared with numbers",
        "Reports a comparison that a variable which may be `none` is more than a number.",
        "clingo orders words after all numbers, so the comparison holds where there is no value.",
        "%*! width(R: road, W: metres | {none})\nR is W wide.\n*%\n#defined width/2.\n"
        "wide(R) :- width(R, W), W > 9.\n#show wide/1.\n",
        "%*! width(R: road, W: metres | {none})\nR is W wide.\n*%\n#defined width/2.\n"
        "wide(R) :- width(R, W), W != none, W > 9.\n#show wide/1.\n",
    ),
    Page(
        "rule-silent",
        "A finding without a message",
        "Reports a rule that derives a finding and has no line `%! because:`.",
        "People would be shown the atom.",
        f"{_CITY}finding(C) :- city(C).\n",
        f"{_CITY}%! because: `{{C}}` is large\nfinding(C) :- city(C).\n",
    ),
    Page(
        "rule-demand",
        "A constraint where rules only derive",
        "Reports a constraint outside of `verify`, unless it is over what `resolve` chooses.",
        "Where facts do not meet it there is no answer at all, and no other finding either.",
        f'{_CITY}:- city(C), C = "Ulm".\n',
        f'{_CITY}closed(C) :- city(C), C = "Ulm".\n#show closed/1.\n',
    ),
    Page(
        "rule-described",
        "A predicate described anew",
        "Reports a description, `%*! ... *%`, of a predicate that is given or public and has one.",
        "The sorts and sentences of the other one count, and readers take these for true.",
        "%*! module(M)\nM is a part.\n*%\nlarge(M) :- module(M).\n#show large/1.\n",
        "large(M) :- module(M).\n#show large/1.\n",
    ),
    Page(
        "rule-unplaced",
        "A node that is never placed",
        "Reports a rule that introduces a node for which no rule derives a place.",
        "No line leads to such a node, so no specification has it.",
        f"{_CITY}inserted(camp(C), camp) :- city(C).\n#show inserted/2.\n",
        f"{_CITY}inserted(camp(C), camp) :- city(C).\nplaced_after(camp(C), C) :- city(C).\n"
        "#show inserted/2. #show placed_after/2.\n",
    ),
    Page(
        "rule-allow",
        "A lint that is allowed in vain",
        "Reports a line `%! allow:` that names no lint, that has no reason, or whose rule has "
        "nothing to allow.",
        "Such a line stays when its reason is gone, and would hide the next fault.",
        f"{_CITY}%! allow: rule-join there are few cities\nlarge(C) :- city(C).\n#show large/1.\n",
        f"{_CITY}%! allow: rule-join there are few cities\n"
        "pair(C, D) :- city(C), city(D), C < D.\n#show pair/2.\n",
    ),
)
#: The codes of all lints.
CODES = frozenset(page.code for page in PAGES)
