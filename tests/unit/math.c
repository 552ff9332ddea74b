/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The doors of the mathematics by identities: what is multiplied out is divided, factored, inverted or summed back,
 * exactly or within the enclosures; enclosures are held against values that MPFR has from closed forms. */
#include "math_cases.h"

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(poly_values),
		cmocka_unit_test(poly_content_times_primitive),
		cmocka_unit_test(poly_product_divided),
		cmocka_unit_test(poly_common_divisor),
		cmocka_unit_test(poly_common_divisor_beyond_the_screen),
		cmocka_unit_test(poly_square_free_factors),
		cmocka_unit_test(polymat_times_adjugate),
		cmocka_unit_test(polymat_blocks),
		cmocka_unit_test(matrix_products),
		cmocka_unit_test(matrix_inverse),
		cmocka_unit_test(matrix_free_column),
		cmocka_unit_test(matrix_of_a_state),
		cmocka_unit_test(echelon_against_its_rows),
		cmocka_unit_test(rectangle_exponential),
		cmocka_unit_test(null_rectangles_of_sums),
		cmocka_unit_test(roots_multiplied_back),
		cmocka_unit_test(residues_of_double_pairs),
		cmocka_unit_test(residues_of_powers_of_time),
		cmocka_unit_test(residues_of_real_poles),
		cmocka_unit_test(a_response_asked_anew),
		cmocka_unit_test(responses_along_a_course),
		cmocka_unit_test(taylor_times_its_inverse),
		cmocka_unit_test(taylor_doubled_twice),
		cmocka_unit_test(taylor_of_sums),
		cmocka_unit_test(taylor_of_known_eigenvalues),
		cmocka_unit_test(taylor_of_few_bits),
		cmocka_unit_test(taylor_of_a_chain),
		cmocka_unit_test(record_of_programs),
		cmocka_unit_test(record_of_matrices),
		cmocka_unit_test(record_of_others),
	};
	choose_cases(argc, argv);
	memory_open();
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return status;
}
