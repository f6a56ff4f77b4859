"""The oracles name problems by words, as this project did before they had codes."""

from __future__ import annotations

WORDS = {
    "M001.syntax": "syntax",
    "M001.empty": "empty-file",
    "M001.foreign": "foreign-format",
    "M001.references": "foreign-format",
    "M004.brace": "surplus-brace",
    "M005.unknown_key": "unknown-key",
    "M006.misspelt": "misspelt-key",
    "M007.listed_only": "no-node-model",
    "M007.nothing_listed": "no-node-model",
    "M007.several_models": "ambiguous-model",
    "M009.short": "short-reference",
    "M009.undefined": "unresolved-reference",
    "M009.question_mark": "unresolved-name",
    "M012.several_types": "ambiguous-type",
    "M012.type": "bad-type",
    "M012.subscribed_types": "type-conflict",
    "M012.two_types": "type-conflict",
    "M015.empty": "empty-topic",
    "M015.namespace": "glued-namespace",
    "M015.illegal": "illegal-name",
    "M018": "duplicate-label",
    "M019": "ros2-action",
    "M020.used_before": "moved-id",
    "M020.changed": "changed-id",
    "M022.no_match": "unmatched-filter",
    "M022.no_topic": "unmatched-filter",
    "M023.part_of_itself": "subsystem-cycle",
    "M023.missing": "subsystem-missing",
    "M023.requires": "unmet-requires",
    "M026.needed": "kept-entry",
    "M026.stays": "kept-entry",
    "M026.dropped": "dropped-entry",
    "M026.comments": "lost-comment",
}


def as_word(case: str) -> str:
    """Return ``surplus-brace`` for M004.brace, or for the code of one case."""
    return next(word for known, word in WORDS.items() if known.startswith(case))
