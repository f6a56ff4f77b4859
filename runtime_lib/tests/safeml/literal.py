"""The three statistics as the literature defines them: slow, exact, without a single trick."""

from fractions import Fraction


def kolmogorov_smirnov(reference, window):
    """n m D."""
    n, m = len(reference), len(window)
    points = [*reference, *window]
    return max(
        abs(sum(x <= z for x in reference) * m - sum(w <= z for w in window) * n) for z in points
    )


def cramer_von_mises(reference, window):
    n, m = len(reference), len(window)
    squares = sum(
        (Fraction(sum(x <= z for x in reference), n) - Fraction(sum(w <= z for w in window), m))
        ** 2
        for z in [*reference, *window]
    )
    return float(Fraction(n * m, (n + m) ** 2) * squares)


def anderson_darling(reference, window):
    n, m = len(reference), len(window)
    pooled = [*reference, *window]
    total = Fraction(0)
    for z in sorted(set(pooled))[:-1]:
        equal = sum(p == z for p in pooled)
        b = sum(p <= z for p in pooled)
        of_reference = sum(x <= z for x in reference)
        total += Fraction(equal * ((n + m) * of_reference - n * b) ** 2, b * (n + m - b))
    return float(total / (n * m))


LITERAL = {"ks": kolmogorov_smirnov, "cvm": cramer_von_mises, "ad": anderson_darling}
