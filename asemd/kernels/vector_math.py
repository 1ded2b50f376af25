"""exp, log, erfc, pow, sin, cos and atan2 without branches and without calls, so that loops over them become vector code.

Compiled with ``contract`` as the only fastmath flag: reordering would cost the digits that the split constants keep. Errors in
units of the last digit: exp 1, log 1, erfc 4 (down to where it underflows), pow(x, y) 1 + abs(y log x), sin and cos 1 (up to abs(x) = 1e6,
in single precision 1e3; further on they lose as many digits as x has before its point), atan2 0.8.
The ``single_`` functions are the twins for single precision, pasted with every literal as ``real(...)``.
"""
from __future__ import annotations

import hashlib
import math
from pathlib import Path

import numpy as np

from asemd.kernels import bits
from asemd.kernels.bits import exponent, nearest_integer, power_of_two, significand, upper_half, within
from asemd.kernels.fuse import madd
from asemd.kernels.generate import Builder, plain_source

OPTIONS = "fastmath={'contract'}, forceinline=True"


def vector_exp(x):
    """e^x for double x: 0 below -708, e^709.4 above 709.4.

    x = k log 2 + r, abs(r) < 0.35, and a Taylor series in r.
    """
    y = within(x, -708.0, 709.4)
    k = nearest_integer(y * 1.4426950408889634)
    r = (y - k * 6.93147180369123816490e-01) - k * 1.90821492927058770002e-10
    p = 1.6059043836821613e-10
    p = p * r + 2.08767569878681e-09
    p = p * r + 2.505210838544172e-08
    p = p * r + 2.755731922398589e-07
    p = p * r + 2.7557319223985893e-06
    p = p * r + 2.48015873015873e-05
    p = p * r + 0.0001984126984126984
    p = p * r + 0.001388888888888889
    p = p * r + 0.008333333333333333
    p = p * r + 0.041666666666666664
    p = p * r + 0.16666666666666666
    p = p * r + 0.5
    e = (1.0 + (r + (r * r) * p)) * power_of_two(k)
    return 0.0 if x < -708.0 else e


def vector_log(x):
    """Natural logarithm of a double x > 0 (normal numbers).

    x = 2^k (1 + f), and log(1 + f) = 2 artanh(s), s = f / (2 + f), arranged so that the largest terms come in last.
    """
    k = exponent(x)
    f = significand(x) - 1.0
    s = f / (2.0 + f)
    z = s * s
    p = 0.09523809523809523
    p = p * z + 0.10526315789473684
    p = p * z + 0.11764705882352941
    p = p * z + 0.13333333333333333
    p = p * z + 0.15384615384615385
    p = p * z + 0.18181818181818182
    p = p * z + 0.2222222222222222
    p = p * z + 0.2857142857142857
    p = p * z + 0.4
    p = p * z + 0.6666666666666666
    h = 0.5 * f * f
    return k * 6.93147180369123816490e-01 - ((h - (s * (h + p * z) + k * 1.90821492927058770002e-10)) - f)


def vector_erfc(x):
    """Complementary error function of a double.

    (1 + 2x) e^(x^2) erfc(x) is a polynomial in (x - 3.75) / (x + 3.75) [1]_, here of degree 24 by Chebyshev interpolation; x^2 is summed
    from an exact and a small part.

    .. [1] Shepherd and Laframboise, Math. Comput. 36, 249 (1981)
    """
    a = abs(x)
    a = 27.5 if a > 27.5 else a
    t = 2.0 * a / (a + 3.75) - 1.0      # (a - 3.75) / (a + 3.75), with less error near a = 0
    p = 4.2514714447963895e-10
    p = p * t + 3.1114333809799254e-10
    p = p * t - 5.1739902140113095e-09
    p = p * t - 3.744210080962018e-09
    p = p * t + 3.8675334242222354e-08
    p = p * t + 2.3263508708859124e-08
    p = p * t - 2.5866850716155884e-07
    p = p * t - 5.7218230603224086e-08
    p = p * t + 1.751637648849062e-06
    p = p * t - 9.73559896736775e-07
    p = p * t - 1.1444146237700524e-05
    p = p * t + 2.238423915508223e-05
    p = p * t + 5.164909889268241e-05
    p = p * t - 0.0002901540805408417
    p = p * t + 0.0002937136655913448
    p = p * t + 0.0017556258528952954
    p = p * t - 0.009746579558029276
    p = p * t + 0.028362277418956406
    p = p * t - 0.05869339858963677
    p = p * t + 0.09230432116037748
    p = p * t - 0.10880393014174886
    p = p * t + 0.0822767384901452
    p = p * t + 0.0035854154854644293
    p = p * t - 0.14024059858554697
    p = p * t + 1.2375126308378275
    h = upper_half(a)
    d = (a - h) * (a + h)
    e = vector_exp(-(h * h))
    e = (e - e * (d * (1.0 - d * (0.5 - d * 0.16666666666666666)))) * (p / (1.0 + 2.0 * a))
    return 2.0 - e if x < 0.0 else e


def vector_atan2(y, x):
    """Angle of the point (x, y), -pi to pi, like `math.atan2`; error below 0.8 of the last digit.

    With z = min / max of abs(x), abs(y) and t = z or (z - 1) / (z + 1) the angle is k pi/4 + arctan t or k pi/4 - arctan t, abs(t) <= 1/2.
    """
    a, b = abs(y), abs(x)
    swap = a > b
    small, large = b if swap else a, a if swap else b
    turned = small > 0.5 * large
    above = small - large if turned else small          # exact
    below = small + large if turned else large
    lost = small - (below - large) if turned else 0.0   # what rounding took from `below`
    inverse = 1.0 / below if below > 0.0 else 0.0
    t = above * inverse
    rest = inverse * (madd(-t, below, above) - t * lost)      # what rounding took from t
    z = t * t
    p = -0.009215792047089858
    p = p * z + 0.025006503566489507
    p = p * z - 0.03806653672057366
    p = p * z + 0.04628024868570153
    p = p * z - 0.05240099507994713
    p = p * z + 0.05879578429582425
    p = p * z - 0.06666435677235948
    p = p * z + 0.07692294712540285
    p = p * z - 0.09090908620322523
    p = p * z + 0.11111111100917376
    p = p * z - 0.14285714285599188
    p = p * z + 0.19999999999999488
    p = p * z - 0.3333333333333333
    rest = rest + (t * z) * p
    k = 1.0 if turned else 0.0
    k = 2.0 - k if swap else k
    k = 4.0 - k if x < 0.0 else k
    back = swap != (x < 0.0)
    t, rest = -t if back else t, -rest if back else rest
    return math.copysign(k * 0.7853981633974483 + (t + (rest + k * 3.061616997868383e-17)), y)


def vector_root(x):
    """1 / sqrt(x) for double x from 1e-37 to 1e37, to 1 unit of the last digit.

    Roots and divisions of vectors of doubles take three times as long as estimates in single precision, which one step of fifth order mends
    (an estimate has at least eleven bits, see `rough_roots`).
    """
    y = np.float64(np.float32(1.0) / math.sqrt(np.float32(x)))
    e = madd(-x, y * y, 1.0)
    return madd(y * e, madd(madd(madd(0.2734375, e, 0.3125), e, 0.375), e, 0.5), y)


def single_root(x):
    """1 / sqrt(x) in single precision: an estimate and one step."""
    return np.float32(1.0) / math.sqrt(x)


def vector_inverse(x):
    """1 / x for double x from 1e-37 to 1e37, to 1 unit of the last digit; see `vector_root`."""
    y = np.float64(np.float32(1.0) / np.float32(x))
    e = madd(-x, y, 1.0)
    return madd(y, madd(e, e, e), y)


def vector_pow(x, y):
    """x^y for doubles, x > 0."""
    return vector_exp(y * vector_log(x))


def sine_and_cosine(x):
    """Of r = x - k pi/2, abs(r) < pi/4 and a little, and k without its multiples of 4, from -2 to 2: (k, sin r, cos r).

    pi/2 is taken off in three parts, of which the first two have 33 digits, so that their products with k are exact. Then Taylor series.
    """
    k = nearest_integer(x * 0.6366197723675814)
    a = x - k * 1.5707963267341256
    b = k * 6.077100506303966e-11
    c = a - b
    lost = (a - c) - b
    d = k * 2.0222662487959506e-21
    r = c - d
    lost = lost + ((c - r) - d)
    z = r * r
    s = 2.8114572543455206e-15
    s = s * z - 7.647163731819816e-13
    s = s * z + 1.6059043836821613e-10
    s = s * z - 2.505210838544172e-08
    s = s * z + 2.7557319223985893e-06
    s = s * z - 0.0001984126984126984
    s = s * z + 0.008333333333333333
    s = s * z - 0.16666666666666666
    c = 4.779477332387385e-14
    c = c * z - 1.1470745597729725e-11
    c = c * z + 2.08767569878681e-09
    c = c * z - 2.755731922398589e-07
    c = c * z + 2.48015873015873e-05
    c = c * z - 0.001388888888888889
    c = c * z + 0.041666666666666664
    h = 0.5 * z
    w = 1.0 - h
    return k - 4.0 * nearest_integer(k * 0.25), r + (r * z * s + lost * w), w + (((1.0 - w) - h) + (z * z * c - r * lost))


def vector_sin(x):
    """Sine of a double; see `sine_and_cosine`."""
    k, s, c = sine_and_cosine(x)
    t = c if abs(k) == 1.0 else s
    return -t if (k < -0.5) | (k > 1.5) else t


def vector_cos(x):
    """Cosine of a double; see `sine_and_cosine`."""
    k, s, c = sine_and_cosine(x)
    t = s if abs(k) == 1.0 else c
    return -t if (k > 0.5) | (k < -1.5) else t


def single_sine_and_cosine(x):
    """`sine_and_cosine` in single precision: four parts of pi/2, with 12 digits."""
    k = nearest_integer(x * 0.6366197723675814)
    a = x - k * 1.5703125
    b = k * 0.0004837512969970703
    c = a - b
    lost = (a - c) - b
    d = k * 7.549533620476723e-08
    r = c - d
    lost = (lost + ((c - r) - d)) - k * 2.563344151594519e-12
    z = r * r
    s = 2.7557319223985893e-06
    s = s * z - 0.0001984126984126984
    s = s * z + 0.008333333333333333
    s = s * z - 0.16666666666666666
    c = 2.48015873015873e-05
    c = c * z - 0.001388888888888889
    c = c * z + 0.041666666666666664
    h = 0.5 * z
    w = 1.0 - h
    return k - 4.0 * nearest_integer(k * 0.25), r + (r * z * s + lost * w), w + (((1.0 - w) - h) + (z * z * c - r * lost))


def single_exp(x):
    """e^x in single precision: 0 below -87, e^88 above 88."""
    y = within(x, -87.0, 88.0)
    k = nearest_integer(y * 1.4426950408889634)
    r = (y - k * 0.693359375) + k * 2.12194440e-4
    p = 0.0001984126984126984
    p = p * r + 0.001388888888888889
    p = p * r + 0.008333333333333333
    p = p * r + 0.041666666666666664
    p = p * r + 0.16666666666666666
    p = p * r + 0.5
    e = (1.0 + (r + (r * r) * p)) * power_of_two(k)
    return 0.0 if x < -87.0 else e


def single_log(x):
    """Natural logarithm in single precision, x > 0 (normal numbers)."""
    k = exponent(x)
    f = significand(x) - 1.0
    s = f / (2.0 + f)
    z = s * s
    p = 0.2222222222222222
    p = p * z + 0.2857142857142857
    p = p * z + 0.4
    p = p * z + 0.6666666666666666
    h = 0.5 * f * f
    return k * 0.693359375 - ((h - (s * (h + p * z) - k * 2.12194440e-4)) - f)


def single_erfc(x):
    """Complementary error function in single precision; see `vector_erfc`."""
    a = abs(x)
    a = 10.0 if a > 10.0 else a
    t = 2.0 * a / (a + 3.75) - 1.0
    p = 2.2046718905694024e-05
    p = p * t - 0.00022411674674416022
    p = p * t + 0.00033016745627228067
    p = p * t + 0.001675912217981131
    p = p * t - 0.009770087183368234
    p = p * t + 0.02840925236412726
    p = p * t - 0.05868544049363111
    p = p * t + 0.09229076959130378
    p = p * t - 0.10880522754949953
    p = p * t + 0.08227841998347046
    p = p * t + 0.00358549531406309
    p = p * t - 0.1402406583213864
    p = p * t + 1.2375126300326993
    h = upper_half(a)
    d = (a - h) * (a + h)
    e = vector_exp(-(h * h)) * (1.0 - d * (1.0 - d * (0.5 - d * (0.16666666666666666 - d * 0.041666666666666664)))) * p / (1.0 + 2.0 * a)
    return 2.0 - e if x < 0.0 else e


def paste(b: Builder, single: bool = False) -> None:
    """Put ``vector_exp``, ``vector_log``, ``vector_erfc``, ``vector_pow``, ``vector_sin`` and ``vector_cos`` into a module.

    Parameters
    ----------
    b : Builder
        Receives the text; the hash of `asemd.kernels.bits` goes in as a comment, so that a change there makes a new module.
    single : bool
        The functions for single precision; the module must define ``real``.
    """
    mark = hashlib.sha256(Path(bits.__file__).read_bytes()).hexdigest()[:16]
    names = "exponent, nearest_integer, power_of_two, significand, upper_half, within"
    b.line(f"from asemd.kernels.bits import {names}  # {mark}")
    pairs = ((single_exp, "exp"), (single_log, "log"), (single_erfc, "erfc")) if single else (
        (vector_exp, "exp"), (vector_log, "log"), (vector_erfc, "erfc"))
    b.text(plain_source(single_sine_and_cosine if single else sine_and_cosine, "sine_and_cosine", real=single), OPTIONS, apart=True)
    for function, name in pairs + ((vector_pow, "pow"), (vector_sin, "sin"), (vector_cos, "cos")):
        b.text(plain_source(function, f"vector_{name}", real=single), OPTIONS, apart=True)


def paste_roots(b: Builder, single: bool = False) -> None:
    """Put ``vector_root`` and, for doubles, ``vector_inverse`` into a module; it must define ``madd``."""
    for function in (single_root,) if single else (vector_root, vector_inverse):
        b.text(plain_source(function, "vector_root" if single else None),
               "fastmath={'contract', 'arcp', 'afn', 'ninf'}, forceinline=True", apart=True)    # estimates will do
