/* Rows of numbers as text: mbkf/io/number_text.py. A number x is scaled by a power of ten that is exact, 10^k, and the
 * product's rounding error by a fused multiply-add, so that its digits are those of x rounded correctly. */
#include <math.h>
#include <string.h>

#include "declared.h"

enum { MOST_POWER = 22, MOST_DIGITS = 14, LONGEST = 24 };
static const double POWERS[MOST_POWER + 1] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                              1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* Whole part of x 10^k below 2^53, x > 0, rounded to the nearest, halves to even. */
static long long rounded(double x, int k)
{
    const double product = x * POWERS[k], error = fma(x, POWERS[k], -product), whole = floor(product);
    const double beyond_half = (product - whole - 0.5) + error;
    const long long below = (long long)whole;
    return below + (beyond_half > 0.0 || (beyond_half == 0.0 && below % 2));
}

/* Writes the digits of a number, zeros before them up to a width; returns the end. */
static char *digits_of(long long number, int width, char *text)
{
    char found[20];
    int size = 0;
    for (; number || size < width; number /= 10)
        found[size++] = (char)('0' + number % 10);
    while (size)
        *text++ = found[--size];
    return text;
}

/* As "%.<decimals>f"; NULL where the number has too many digits. */
static char *fixed(double x, int decimals, char *text)
{
    if (decimals > MOST_DIGITS || !(x * POWERS[decimals] < 1e15))
        return NULL;
    long long number = rounded(x, decimals), unit = (long long)POWERS[decimals];
    text = digits_of(number / unit, 1, text);
    if (!decimals)
        return text;
    *text++ = '.';
    return digits_of(number % unit, decimals, text);
}

/* As "%.<digits>g", x > 0; NULL where x is so large or small that no power is exact. */
static char *general(double x, int digits, char *text)
{
    int exponent = (int)floor(log10(x)), k = digits - 1 - exponent;
    if (digits > MOST_DIGITS || k < 1 || k >= MOST_POWER)
        return NULL;
    /* the logarithm may be off by one next to a power of ten */
    if (x * POWERS[k] < POWERS[digits - 1])
        k++;
    long long number = rounded(x, k);
    if (number >= (long long)POWERS[digits])
        number = rounded(x, --k);
    exponent = digits - 1 - k;
    char found[20];
    int size = (int)(digits_of(number, digits, found) - found);
    while (size > 1 && found[size - 1] == '0')
        size--;
    if (exponent < -4 || exponent >= digits) {
        *text++ = found[0];
        if (size > 1)
            *text++ = '.';
        memcpy(text, found + 1, (size_t)size - 1);
        text += size - 1;
        *text++ = 'e';
        *text++ = exponent < 0 ? '-' : '+';
        return digits_of(exponent < 0 ? -exponent : exponent, 2, text);
    }
    if (exponent < 0) {
        *text++ = '0';
        *text++ = '.';
        for (int zeros = -exponent - 1; zeros; zeros--)
            *text++ = '0';
    }
    for (int n = 0; n < size || n <= exponent; n++) {
        if (n && n == exponent + 1)
            *text++ = '.';
        *text++ = n < size ? found[n] : '0';
    }
    return text;
}

static char *number(double x, int digits, char *text)
{
    if (isnan(x)) {
        memcpy(text, "nan", 3);
        return text + 3;
    }
    if (signbit(x))
        *text++ = '-';
    x = fabs(x);
    if (isinf(x)) {
        memcpy(text, "inf", 3);
        return text + 3;
    }
    if (digits <= 0)
        return fixed(x, -digits, text);
    if (x == 0.0) {
        *text++ = '0';
        return text;
    }
    return general(x, digits, text);
}

int mbkf_number_rows(int rows, int columns, int size, const double *values, const int *digits, int begin,
                     char *text, int *written)
{
    char *end = text;
    *written = 0;
    for (int row = begin; row < rows; row++, *written = (int)(end - text)) {
        if (size - *written < LONGEST * columns)
            return row;
        for (int column = 0; column < columns; column++) {
            end = number(values[(long)row * columns + column], digits[column], end);
            if (!end)
                return row;
            *end++ = column + 1 < columns ? '\t' : '\n';
        }
    }
    return rows;
}
