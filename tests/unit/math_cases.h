/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the tests of the mathematics share; each math_NAME.c has those of its subject, math.c runs all of them. */
#ifndef MATH_CASES_H
#define MATH_CASES_H

#include "draw.h"
#include "emit/text.h"

#include <string.h>

enum { CASES = 300, TRUE_BITS = 600 };

/* math_polynomials.c */
struct poly draw_poly(int degree, long most);
struct poly linear_poly(long a, long b);          /* a s + b */
struct poly one_poly(void);
const char *text_of(struct poly p);
struct poly primitive_of(struct poly p);

/* math_matrices.c */
mpq_t *draw_matrix(int rows, int columns);
void assert_rational(const char *what, int n, int i, int j, mpq_srcptr found, mpq_srcptr expected);
mpq_t *unit_matrix(int n);
void add_product(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b);

/* math_residues.c */
void assert_interval(const char *what, int n, mpfi_srcptr found, mpfr_srcptr truth);
void assert_narrow(const char *what, int n, mpfi_srcptr found, long bits);
void add_wave(mpfr_ptr sum, mpq_srcptr a, mpq_srcptr w, mpq_srcptr t, mpq_srcptr factor, int power, bool sine);

/* The cases */
void poly_values(void **state);
void poly_content_times_primitive(void **state);
void poly_product_divided(void **state);
void poly_common_divisor(void **state);
void poly_common_divisor_beyond_the_screen(void **state);
void poly_square_free_factors(void **state);
void polymat_times_adjugate(void **state);
void polymat_blocks(void **state);
void matrix_products(void **state);
void matrix_inverse(void **state);
void matrix_free_column(void **state);
void matrix_of_a_state(void **state);
void echelon_against_its_rows(void **state);
void rectangle_exponential(void **state);
void null_rectangles_of_sums(void **state);
void roots_multiplied_back(void **state);
void residues_of_double_pairs(void **state);
void residues_of_powers_of_time(void **state);
void residues_of_real_poles(void **state);
void a_response_asked_anew(void **state);
void responses_along_a_course(void **state);
void taylor_times_its_inverse(void **state);
void taylor_doubled_twice(void **state);
void taylor_of_sums(void **state);
void taylor_of_known_eigenvalues(void **state);
void taylor_of_few_bits(void **state);
void taylor_of_a_chain(void **state);
void record_of_programs(void **state);
void record_of_matrices(void **state);
void record_of_others(void **state);

#endif
