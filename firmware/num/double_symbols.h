/* Names of the double build. All code on real_t is built twice, in float and in double, and a host program may hold both.
 * So the functions of the double build have a suffix, which sources and callers never see. Each such function has a line. */
#ifndef REFLUX_NUM_DOUBLE_SYMBOLS_H
#define REFLUX_NUM_DOUBLE_SYMBOLS_H

#ifdef REFLUX_REAL_DOUBLE
#define real_sincos                real_sincos_double
#define matrix_check               matrix_check_double
#define matrix_multiply            matrix_multiply_double
#define matrix_transpose           matrix_transpose_double
#define matrix_equilibrate         matrix_equilibrate_double
#define matrix_pseudo_inverse      matrix_pseudo_inverse_double
#define lu_factor                  lu_factor_double
#define lu_solve                   lu_solve_double
#define lu_inverse                 lu_inverse_double
#define lu_determinant             lu_determinant_double
#define cmatrix_check              cmatrix_check_double
#define cmatrix_pseudo_inverse     cmatrix_pseudo_inverse_double
#define clu_factor                 clu_factor_double
#define clu_factor_own             clu_factor_own_double
#define clu_inverse_diagonal       clu_inverse_diagonal_double
#define cmatrix_invert_own         cmatrix_invert_own_double
#define clu_solve                  clu_solve_double
#define clu_determinant            clu_determinant_double
#define ceigen_values              ceigen_values_double
#define ceigen_follow              ceigen_follow_double
#define svd_begin                  svd_begin_double
#define svd_step                   svd_step_double
#define svd_decompose              svd_decompose_double
#define svd_rank                   svd_rank_double
#define svd_condition              svd_condition_double
#define svd_pseudo_inverse         svd_pseudo_inverse_double
#define random_normal              random_normal_double
#define ud_set_diagonal            ud_set_diagonal_double
#define ud_project                 ud_project_double
#define ud_correct_from            ud_correct_from_double
#define ud_add                     ud_add_double
#define ud_add_at                  ud_add_at_double
#define ud_add_pair                ud_add_pair_double
#define ud_scale                   ud_scale_double
#define ud_multiply                ud_multiply_double
#define ud_solve                   ud_solve_double
#define ud_element                 ud_element_double
#define ud_trace                   ud_trace_double
#define ud_extremes                ud_extremes_double
#define ud_clamp                   ud_clamp_double
#define polynomial_set             polynomial_set_double
#define polynomial_check           polynomial_check_double
#define polynomial_add_product     polynomial_add_product_double
#define polynomial_delay           polynomial_delay_double
#define polynomial_advance         polynomial_advance_double
#define polynomial_trim            polynomial_trim_double
#define polynomial_value           polynomial_value_double
#define polynomial_size            polynomial_size_double
#define polynomial_zeros_within    polynomial_zeros_within_double
#define polynomial_matrix_check    polynomial_matrix_check_double
#define polynomial_matrix_multiply polynomial_matrix_multiply_double
#define polynomial_determinant     polynomial_determinant_double
#define polynomial_adjugate        polynomial_adjugate_double
#define polynomial_find_roots      polynomial_find_roots_double
#endif

#endif
