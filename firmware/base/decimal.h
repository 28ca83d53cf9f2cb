/* Decimal numbers as long as a float needs: the exact value of a float in digits, and the float nearest to digits.
 *
 * The code uses integers only and rounds nothing on the way. A decimal number can be halved and doubled exactly,
 * because 2 divides 10. A conversion therefore only shifts it by the float's exponent, as the slow path of Go's
 * strconv/decimal.go does. The code is small rather than fast: a number of everyday size takes one short shift, the
 * ends of the range take six.
 */
#ifndef REFLUX_BASE_DECIMAL_H
#define REFLUX_BASE_DECIMAL_H

#include <stdbool.h>
#include <stdint.h>

#define DECIMAL_READ  40 /* most digits of a number that is read */
#define DECIMAL_KEPT  87 /* digits kept between two steps */
#define DECIMAL_SPARE 9  /* digits by which one shift to the left grows a number */

/* The number 0.d1d2d3... * 10^point. Neither d1 nor the last digit is 0; a number without digits is zero. `more` says
 * that a digit other than 0 found no room. A number with at most DECIMAL_READ digits that is halfway between two floats,
 * or between two texts of nine digits, always has room. Rounding therefore takes `more` as "above". */
struct decimal {
    uint8_t n;
    bool more;
    int16_t point;
    uint8_t digit[DECIMAL_KEPT + DECIMAL_SPARE];
};

/* Sets *d to |x|, exactly. x is finite. */
void decimal_of_float(struct decimal *d, float x);
/* Rounds to the nearest number of at most n digits, n = 1..9; of two equally near ones to the even one. */
void decimal_round(struct decimal *d, unsigned n);
/* Returns the nearest float, of two equally near ones the even one; infinity beyond the largest. *d holds at most
 * DECIMAL_READ digits, which may begin and end with zeros. The function destroys *d. */
float decimal_to_float(struct decimal *d);

#endif
