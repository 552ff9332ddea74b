/* SPDX-License-Identifier: MIT-0 */
/* Steps that go from crossing to crossing beside the equations by hand, located in long double: the order that is
 * stated, errors by the tolerance, every crossing. TABLE=1: figures. */
#ifndef VARIANTS                            /* of the schemes that are tested: taylor; radau and auto */
#define VARIANTS "events_variants.h"
#define VARIANT_TABLE events_table
#endif
#ifndef SYSTEMS
#define SYSTEMS switched_systems
#define SYSTEM_COUNT switched_count
enum { RESOLVED = 1 };                      /* what passes a breakpoint does so well above its rounding */
#else
enum { RESOLVED = 0 };
#endif
#include VARIANTS
#include "followed.h"
#include "tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const struct variant *variant_called(const char *name)
{
	return variant_in(VARIANT_TABLE, name);
}

/* The three steps of one order */
static void check_order(const struct switched_system *s, const struct truth *truth, int order)
{
	struct found found[3];
	bool counted = true;
	for (int k = 0; k < 3; k++) {
		char name[64];
		(void)snprintf(name, sizeof name, "%s_order%d_%d", s->name, order, k);
		if (!variant_called(name))
			return;
		found[k] = follow(variant_called(name), s, truth);
		counted = counted && found[k].count == truth->count && found[k].status == 0;
	}
	const double measured = log2(found[0].error / found[2].error) / 2;
	if (!ok(fabs(measured - order) < 0.15, "%s: order %d", s->name, order))
		note("measured %.3f, from errors %.3g, %.3g, %.3g", measured, found[0].error, found[1].error,
			 found[2].error);
	if (!ok(counted, "%s, order %d: %d crossings", s->name, order, truth->count))
		note("found %d, %d, %d; status %d, %d, %d", found[0].count, found[1].count, found[2].count,
			 found[0].status, found[1].status, found[2].status);
	if (getenv("TABLE"))
		printf("| %s | %d | %.3f | %.2g | %.2g | %.2g |\n", s->name, order, measured, found[0].error,
				found[1].error,
			   found[2].error);
}

/* Whether there is such a variant */
static int check_tolerance(const struct switched_system *s, const struct truth *truth, const char *scheme, int digits)
{
	char name[64];
	(void)snprintf(name, sizeof name, "%s_%s%d_0", s->name, scheme, digits);
	if (!variant_called(name))
		return 0;
	const struct found found = follow(variant_called(name), s, truth);
	const double tolerance = pow(10, -digits);
	if (!ok(found.error < 100 * tolerance && found.count == truth->count && found.status == 0,
			"%s, %s 1e-%d: error, %d crossings", s->name, scheme, digits, truth->count))
		note("error %.3g, %d crossings, status %d", found.error, found.count, found.status);
	/* beside collocation they are ends of its steps, which are more exact */
	const bool end = RESOLVED && strcmp(scheme, "radau") == 0 && digits == 11;
	if (!ok(found.time < (end ? 1e-13 : 1000 * tolerance), "%s, %s 1e-%d: times of crossings", s->name, scheme,
			digits))
		note("off by %.3g s", found.time);
	if (getenv("TABLE"))
		printf("| %s | %s | 1e-%d | %.2g | %.2g | %d |\n", s->name, scheme, digits, found.error, found.time,
			   found.count);
	return 1;
}

int main(void)
{
	for (int i = 0; i < SYSTEM_COUNT; i++) {
		const struct switched_system *s = &SYSTEMS[i];
		const struct truth truth = truth_of(s);
		for (int order = 4; order <= 8; order += 2)
			check_order(s, &truth, order);
		int tolerances = 0;
		for (int digits = 4; digits <= 13; digits++)
			tolerances += check_tolerance(s, &truth, "by", digits) + check_tolerance(s, &truth, "radau",
					digits) +
				check_tolerance(s, &truth, "auto", digits);
		ok(tolerances >= 3, "%s: %d tolerances", s->name, tolerances);
	}
	return tap_end();
}
