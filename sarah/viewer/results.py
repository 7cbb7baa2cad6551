"""Results of the shown episode, as HTML."""

from __future__ import annotations

import html

from sarah.episode.ending import ending_words
from sarah.episode.result import METRICS, EpisodeResult


def paragraph(*lines: str) -> str:
    """Lines of text as HTML.

    :param lines: text, in which nothing is HTML
    """
    text = "<br>".join(html.escape(line) or "&nbsp;" for line in lines)
    return f"<div style='padding: 0.2em 0.9em; font-size: 0.85em; line-height: 1.4'>{text}</div>"


def _ending(result: EpisodeResult) -> str:
    """Way in which an episode ended, and the time if it ended early."""
    return ending_words(result.termination) + ("" if result.survived else f" at {result.duration:.1f} s")


def comparison(shown: EpisodeResult, before: EpisodeResult | None, noted_score: float | None) -> str:
    """Table of the results as HTML, beside those of the episode that was shown before.

    :param shown: result of the episode on the page
    :param before: result of the episode that was there before it
    :param noted_score: score of the same episode in its run folder
    """
    rows = [("", "now", "before"), ("", _ending(shown), "" if before is None else _ending(before))]
    for name, metric in METRICS.items():
        if metric.statistics:
            now, then = (
                metric.text(getattr(one, name)) if one and name not in one.unknown else "" for one in (shown, before)
            )
            rows.append((metric.label, now, then))
    lines = [f"<tr><td>{name}</td><td><b>{now}</b></td><td>{old}</td></tr>" for name, now, old in rows]
    note = ""
    if noted_score is not None and abs(noted_score - shown.score) > 1e-9:
        note = f"<p>The run folder has a score of {noted_score:.3f}: another version simulated this episode.</p>"
    return (
        "<div style='padding: 0 0.8em; font-size: 0.8em'><table id='results' style='width: 100%; line-height: 1.35'>"
        f"{''.join(lines)}</table>{note}</div>"
    )
