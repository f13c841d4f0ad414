"""Texts of scenarios that several suites simulate."""


def half_of_hidden(source):
    """The first half of c130-hidden, which has every kind of manoeuvre."""
    text = (source / "data/scenarios/c130-hidden.toml").read_text()
    climb, landing = ("[[leg]]\nkind = " + leg for leg in ('"climb"\naltitude = 5500', '"landing"'))
    return text[:text.index(climb)] + text[text.index(landing):]
