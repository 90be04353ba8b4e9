"""JSON of any depth."""

import json

from mars_asp.cli.encode import _encoded_parts, encoded

PLAIN = {
    "a": [1, 2.5, None, True, '"\\\n\u00e9'],
    "b": {},
    "c": [],
    "d": {"e": [{}, [[]]]},
    "": (),
}


def test_the_parts_join_to_the_output_of_the_standard_library() -> None:
    for value in (PLAIN, [PLAIN, PLAIN], "x", None, []):
        assert "".join(_encoded_parts(value)) == json.dumps(value)


def test_a_deep_value_is_encoded() -> None:
    value: object = "leaf"
    for _ in range(20_000):
        value = {"premises": [value]}
    assert encoded(value) == '{"premises": [' * 20_000 + '"leaf"' + "]}" * 20_000
