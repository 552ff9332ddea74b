/* SPDX-License-Identifier: MIT-0 */
/* agree.h: of models with regions, whether those at rest agree with one: part of impacts.h, behind contacts.h, and of
 * the enclosed run of the generator.  It has no guard, for it is a part of the file that includes it. */

/* ---- what it asks of that file ---- */

/* Between the numbers of regions one interval of a switching function apart; its interval in a region; whether that can
 * be */
static int stride_of(const contacts *m, int expression);
static int interval_in(const contacts *m, int region, int expression);
static int is_possible(const contacts *m, int region);
static int region_now(const instant *at);

/* Whether the force of what is held in a region holds it: 2; 1: it is not known; 0: a guard of it lets it go */
static int holds_in(const contacts *m, instant *at, int region, int expression);

/* The side to which one of those at rest is heading in a region; known: set to 0 where that is not known */
static int heading_in(const contacts *m, instant *at, int region, const resting *one, int *known);

/* Whether it is let go to this side at this instant; known: whether it is where it is heading */
static int is_freed(const contacts *m, const instant *at, int region, const resting *one, int side, int known);

/* ---- */

/* Whether others hold it already where it neither sticks nor rests, for no region holds it twice: friction slips there
 * as it would but for the contacts at rest. */
static int is_spared(const contacts *m, instant *at, int region, const resting *r, int count, const resting *of,
					 int side)
{
	const int stuck = region - side * stride_of(m, of->expression);
	int flying = region, known = 1, i;
	if (is_possible(m, stuck) || of->impact >= 0) {
		return !is_possible(m, stuck);
	}
	for (i = 0; i < count; i++) {
		if (r[i].impact >= 0 && interval_in(m, region, r[i].expression) == r[i].held) {
			flying += (free_of(m, r[i].impact) - r[i].held) * stride_of(m, r[i].expression);
		}
	}
	return is_possible(m, flying) && heading_in(m, at, flying, of, &known) == side && known;
}

/* Whether one of them agrees with a region: what sticks is held, what slips moves away as it does there.  As agrees */
static int agrees_one(const contacts *m, instant *at, int region, const resting *r, int count, const resting *one)
{
	const int side = interval_in(m, region, one->expression) - one->held;
	int way, known = 1;
	if (one->impact >= 0 && side == 0 && speed_of(m, at, one->impact) < 0) {
		return 0;
	}
	if (one->impact >= 0 && side == (m->impact[one->impact].upward ? 1 : -1)) {
		return 0;
	}
	if (side == 0) {
		return holds_in(m, at, region, one->expression);
	}
	way = heading_in(m, at, region, one, &known);
	if (way == side || (way == 0 && known && is_spared(m, at, region, r, count, one, side)) ||
		is_freed(m, at, region, one, side, known)) {
		return 2;
	}
	return !known;
}

static int agrees(const contacts *m, instant *at, const resting *r, int count, const int *interval)
{
	int region = region_now(at), agreed = 2, i;
	for (i = 0; i < count; i++) {
		region += (interval[i] - interval_in(m, region, r[i].expression)) * stride_of(m, r[i].expression);
	}
	if (!is_possible(m, region)) {
		return 0;
	}
	for (i = 0; i < count && agreed != 0; i++) {
		const int one = agrees_one(m, at, region, r, count, &r[i]);
		agreed = one < agreed ? one : agreed;
	}
	return agreed;
}
