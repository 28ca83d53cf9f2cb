/* Decimal numbers as long as a float needs: the exact value of a float in digits, and the float nearest to digits.
 *
 * Integers only, no rounding on the way. A decimal number can be halved and doubled exactly, because 2 divides 10:
 * shifting it by the float's exponent is all there is to it (the way of the slow path in Go's strconv/decimal.go).
 * Small rather than fast: a number of everyday size takes one short shift, the ends of the range take six.
 */
#ifndef REFLUX_BASE_DECIMAL_H
#define REFLUX_BASE_DECIMAL_H

#include <stdbool.h>
#include <stdint.h>

#define DECIMAL_READ  40 /* digits a number may be given with */
#define DECIMAL_KEPT  87 /* digits kept in between */
#define DECIMAL_SPARE 9  /* digits by which one shift to the left grows a number */

/* 0.d1d2d3... * 10^point. d1 is not 0, nor is the last digit; no digits: zero. Digits that found no room are told
 * as `more`. What is halfway between two floats, or two texts of nine digits, and has at most DECIMAL_READ digits,
 * never comes to that: then `more` means above, and is all that rounding needs to know. */
struct decimal {
    uint8_t n;
    bool more;
    int16_t point;
    uint8_t digit[DECIMAL_KEPT + DECIMAL_SPARE];
};

/* |x|, exactly. x is finite. */
void decimal_of_float(struct decimal *d, float x);
/* The nearest of at most n digits, 1..9; of two the even one. */
void decimal_round(struct decimal *d, unsigned n);
/* The nearest float, of two the even one; infinity beyond the largest. The digits given, at most DECIMAL_READ, may
 * begin and end with zeros. *d is used up. */
float decimal_to_float(struct decimal *d);

#endif
