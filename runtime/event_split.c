/* SPDX-License-Identifier: MIT-0 */
/* How a part of a step goes on, of any length, where linear terms are exact: by e^{A tau}.  The stages of a scheme that
 * takes such parts are in event_split.h. */
#include "two.h"

/* ---- x <- e^{A tau} x ---- */

/* TURN: below this bound of |A| tau the series itself, which loses no more than e^TURN units in the last place */
enum { TURN = 2, MOST_TERMS = 64, CHAIN = 3 };

/* So that what is left out is below a unit in the last place; chains of integrators come late */
static int terms_of(real turn)
{
	real term = 1;
	int k;
	for (k = 1; k < MOST_TERMS && term > REAL_EPSILON / 16; k++) {
		term *= turn / (real)k;
	}
	return k + CHAIN;
}

/* next: work */
static void by_series(int size, const real *A, real tau, int terms, const real *x, real *out, real *term, real *next)
{
	int i, k;
	for (i = 0; i < size; i++) {
		out[i] = term[i] = x[i];
	}
	for (k = 1; k <= terms; k++) {
		const real factor = tau / (real)k;
		pl_multiply(size, size, A, term, next);
		for (i = 0; i < size; i++) {
			term[i] = factor * next[i];
			out[i] += term[i];
		}
	}
}

/* D <- e^{A tau} - I for half of tau and, behind it, for all of it.  work: PL_EVENT_SPLIT_ROOM */
static int make_tables(int size, const real *A, real tau, real *D, pl_two *work)
{
	const int cells = size * size;
	pl_two *const exact = work, *const increment = exact + cells;
	real *const whole = D + cells;
	int i, j, k, status;
	for (i = 0; i < cells; i++) {
		exact[i] = two(A[i], 0);
	}
	status = pl_increment(size, size, exact, tau / 2, 1, increment, increment + cells);
	for (i = 0; i < cells; i++) {
		D[i] = increment[i].hi;
	}
	for (i = 0; i < size && status == 0; i++) {
		for (j = 0; j < size; j++) {
			real sum = 2 * D[i * size + j];
			for (k = 0; k < size; k++) {
				sum += D[i * size + k] * D[k * size + j];
			}
			whole[i * size + j] = sum;
		}
	}
	return status;
}

/* ---- the part ---- */

int pl_event_split_begin(pl_event_split *m, int size, const real *A, real fastest, real tau, real *work, pl_two *room)
{
	m->size = size;
	m->terms = fastest * tau <= (real)TURN ? terms_of(fastest * tau) : 0;
	m->A = A;
	m->D = work;
	m->tau = tau;
	m->room = work + 2 * size * size;
	return m->terms != 0 ? 0 : make_tables(size, A, tau, work, room);
}

void pl_event_split_flow(const pl_event_split *m, int half, const real *x, real *out)
{
	int i;
	if (m->terms) {
		by_series(m->size, m->A, half ? m->tau / 2 : m->tau, m->terms, x, out, m->room, m->room + m->size);
		return;
	}
	pl_multiply(m->size, m->size, m->D + (half ? 0 : m->size * m->size), x, out);
	for (i = 0; i < m->size; i++) {
		out[i] += x[i];
	}
}
