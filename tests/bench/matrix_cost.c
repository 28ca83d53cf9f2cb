/* Cost of matrices of 16 x 16: one function a run, for a counter of instructions outside.
 *
 *     matrix_cost NAME        multiply, equilibrate, factor, inverse, pseudo_inverse (of 16 x 16), wide (of 15 x 16)
 *
 * valgrind --tool=callgrind --toggle-collect=measured ... counts what stands in measured() alone (tools/bench). */
#include <stdio.h>
#include <string.h>

#include "num/matrix.h"
#include "num/random.h"

static struct matrix a, b, c;
static struct lu lu;
static struct pseudo_inverse_work work;
static real_t rows[MATRIX_MAX], columns[MATRIX_MAX];

static __attribute__((noinline)) enum err measured(const char *name)
{
    if (strcmp(name, "multiply") == 0)
        return matrix_multiply(&a, &b, &c);
    if (strcmp(name, "equilibrate") == 0) {
        matrix_equilibrate(&a, true, rows, columns);
        return ERR_OK;
    }
    if (strcmp(name, "factor") == 0)
        return lu_factor(&a, &lu);
    if (strcmp(name, "inverse") == 0) {
        lu_inverse(&lu, &c);
        return ERR_OK;
    }
    return matrix_pseudo_inverse(&a, &work, &c);
}

int main(int n, char **v)
{
    if (n != 2) {
        fprintf(stderr, "usage: matrix_cost NAME\n");
        return 2;
    }
    struct random source = random_from(1);
    a.rows = a.cols = b.rows = b.cols = MATRIX_MAX;
    if (strcmp(v[1], "wide") == 0)
        a.rows = MATRIX_MAX - 1;
    for (unsigned i = 0; i < MATRIX_MAX; i++)
        for (unsigned j = 0; j < MATRIX_MAX; j++) {
            a.value[i][j] = random_normal(&source);
            b.value[i][j] = random_normal(&source);
        }
    if (a.rows == a.cols && lu_factor(&a, &lu))
        return 1;
    return measured(v[1]) ? 1 : 0;
}
