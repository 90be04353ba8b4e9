"""Lints that a rule allows, by `%! allow: CODE REASON`, and wrong lines of this kind."""

from collections.abc import Iterable, Iterator, Sequence

from mars_asp.asp.lint.catalogue import CODES
from mars_asp.asp.lint.found import LintFinding, found
from mars_asp.asp.rules.rule import Rule
from mars_asp.spelling import nearest

ALLOW = "rule-allow"


def allowed(rules: Iterable[Rule], findings: Sequence[LintFinding]) -> Iterator[LintFinding]:
    """Yield the findings that no rule allows, and the findings about wrong `allow` lines."""
    owners = {rule.span: rule for rule in rules if rule.listed is None}
    used: set[tuple[object, str]] = set()
    for each in findings:
        owner = owners.get(each.rule.span) if each.rule is not None else None
        code = each.diagnostic.code
        if owner is not None and any(allow.code == code for allow in owner.allows):
            used.add((owner.span, code))
        else:
            yield each
    for rule in owners.values():
        for allow in rule.allows:
            if allow.code not in CODES:
                near = nearest(allow.code, CODES)
                message = f"`{allow.code}` is not a lint"
                listed = f"the lints are {', '.join(sorted(CODES))}"
                advice = f"did you mean `{near}`?" if near else listed
                yield found(ALLOW, message, allow.span, None, advice)
            elif not allow.reason:
                message = f"`{allow.code}` is allowed without a reason"
                advice = f"write `%! allow: {allow.code} REASON`"
                yield found(ALLOW, message, allow.span, None, advice)
            elif (rule.span, allow.code) not in used:
                message = f"the rule has nothing for which `{allow.code}` is allowed"
                yield found(ALLOW, message, allow.span, None, "leave out the line")
