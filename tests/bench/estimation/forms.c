/* The update of P as others write it, in plain C, beside which UDU' is counted. P is symmetric, so what can be done for one half and
 * copied is. */
#include "cost.h"

#ifndef REFLUX_FIXED_POINT

#define MOST 24

static float project(const float *p, size_t n, const float *phi, float v, float *p_phi)
{
    float alpha = v;
    for (size_t i = 0; i < n; i++) {
        float sum = 0;
        for (size_t j = 0; j < n; j++)
            sum += *p++ * phi[j];
        p_phi[i] = sum;
        alpha += sum * phi[i];
    }
    return alpha;
}

/* P = (P - K (P phi)')/v */
float covariance_form(float *p, size_t n, const float *phi, float v, float *gain)
{
    float p_phi[MOST], alpha = project(p, n, phi, v, p_phi), inverse = 1 / alpha, growth = 1 / v;
    for (size_t i = 0; i < n; i++)
        gain[i] = p_phi[i] * inverse;
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++)
            p[i * n + j] = p[j * n + i] = (p[i * n + j] - gain[i] * p_phi[j]) * growth;
    return alpha;
}

/* P = (P - K (P phi)' - (P phi) K' + alpha K K')/v: Joseph's form of one measurement, multiplied out. */
float joseph_form(float *p, size_t n, const float *phi, float v, float *gain)
{
    float p_phi[MOST], alpha = project(p, n, phi, v, p_phi), inverse = 1 / alpha, growth = 1 / v;
    for (size_t i = 0; i < n; i++)
        gain[i] = p_phi[i] * inverse;
    for (size_t i = 0; i < n; i++) {
        float own = gain[i] * alpha - p_phi[i];
        for (size_t j = i; j < n; j++)
            p[i * n + j] = p[j * n + i] =
                (p[i * n + j] - gain[i] * p_phi[j] + own * gain[j]) * growth;
    }
    return alpha;
}

/* P = ((I - K phi') P (I - K phi')' + v K K')/v, as products of matrices. */
float dense_form(float *p, size_t n, const float *phi, float v, float *gain)
{
    static float a[MOST * MOST], ap[MOST * MOST];
    float p_phi[MOST], alpha = project(p, n, phi, v, p_phi), inverse = 1 / alpha, growth = 1 / v;
    for (size_t i = 0; i < n; i++)
        gain[i] = p_phi[i] * inverse;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++)
            a[i * n + j] = (float)(i == j) - gain[i] * phi[j];
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            float sum = 0; /* row by row: P is its own transpose */
            for (size_t k = 0; k < n; k++)
                sum += a[i * n + k] * p[j * n + k];
            ap[i * n + j] = sum;
        }
    for (size_t i = 0; i < n; i++)
        for (size_t j = i; j < n; j++) {
            float sum = v * gain[i] * gain[j];
            for (size_t k = 0; k < n; k++)
                sum += ap[i * n + k] * a[j * n + k];
            p[i * n + j] = p[j * n + i] = sum * growth;
        }
    return alpha;
}

#endif
