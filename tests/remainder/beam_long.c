/* SPDX-License-Identifier: GPL-3.0-or-later */
/* etd1 at Om = 4 and h = 0.0001, the operator at each speed: within 50 s a plot shows nothing of what grows; 500,000
 * steps each. */
#include "beam_long_variants.h"
#include "cantilever.h"
#include "tap.h"

#include <math.h>

int main(void)
{
	enum { SECONDS = 50 };
	for (int w = 0; w <= 6; w++) {
		const pl_model *m = variant_of(beam_long, "beam4_A%d_etd1_0", w)->model;
		double y[CANTILEVER_STATES], most = 0, least = 0;
		void *state = calloc(1, m->size);
		m->init(state);
		for (int row = 1; row <= 200 * SECONDS; row++) {
			m->run(state, (size_t)lround(0.005 / m->h), NULL, NULL);
			m->get(state, y);
			least = fmin(least, y[CANTILEVER_TIP]);
			if (row > 200 * 16)
				most = fmax(most, fabs(y[CANTILEVER_TIP]));
		}
		const bool good = close_to(least, -0.534406, 1e-4, "A(%d): least deflection", w);
		ok(close_to(most, 0.0083, 1e-4, "A(%d): later", w) && good,
				"A(%d): least deflection %.6g m, then up to %.4g m",
			w, least, most);
		free(state);
	}
	return tap_end();
}
