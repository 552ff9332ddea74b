/* SPDX-License-Identifier: MIT-0 */
/* series_rest.h: part of series_impacts.h: what contacts.h asks of those at rest, what is held and what is not. */

static int find_resting(const pl_events *m, const pl_instant *at, resting *found)
{
	int count = 0, i;
	for (i = 0; i < m->holds && count < RESTING; i++) {
		const pl_hold *h = &m->hold[i];
		const int side = at->interval[h->expression] - h->interval;
		if (side < -1 || side > 1) {
			continue;
		}
		if (side != 0 && i != at->freed && !is_still(m, at, h->velocity)) {
			continue;
		}
		if (side != 0 && i != at->freed && h->impact >= 0 && !touches(m, at, h->impact)) {
			continue;
		}
		found[count].expression = h->expression;
		found[count].held = h->interval;
		found[count].impact = h->impact;
		found[count++].hold = i;
	}
	return count;
}

/* Where friction slips of what a contact holds, by bits of all that is held: 1 or -1; 0: it is free to move */
static int side_beside(const pl_events *m, const pl_instant *at, int hold)
{
	const uint64_t held = held_now(m, at) | (uint64_t)1 << hold;
	int i;
	for (i = 0; i < m->conflicts; i++) {
		const pl_conflict *c = &m->conflict[i];
		if (c->hold == hold && (held & c->set) == c->set) {
			return c->watch >= 0 && value_of(m, at, c->watch) < 0 ? -c->side : c->side;
		}
	}
	return 0;
}

static int side_of(const pl_events *m, const pl_instant *at, const resting *r, int *hangs)
{
	const pl_hold *h = &m->hold[r->hold];
	const int side = at->interval[r->expression] - r->held, beside = side_beside(m, at, r->hold);
	int leaves;
	*hangs = 0;
	if (beside != 0) {
		return beside;
	}
	/* Another impact has parted it; without one, a speed is what rounding has left. */
	if (at->starting >= 0 && r->impact >= 0 && speed_of(m, at, r->impact) < 0) {
		return free_of(m, r->impact) - r->held;
	}
	if (side == 0) {
		return lets_go(m, at, r->hold, 1) > 0 ? 1 : lets_go(m, at, r->hold, 0) > 0 ? -1 : 0;
	}
	if ((side > 0 ? h->up : h->down) < 0) {
		return 0;
	}
	leaves = lets_go(m, at, r->hold, side > 0);
	*hangs = leaves == 0;
	return leaves < 0 ? 0 : side;
}

static int agrees(const pl_events *m, pl_instant *at, const resting *r, int count, const int *interval)
{
	int agreed = 2, i;
	for (i = 0; i < count; i++) {
		at->interval[r[i].expression] = interval[i];
	}
	if (!can_be(m, at)) {
		return 0;
	}
	renew(m, at);
	for (i = 0; i < count && agreed != 0; i++) {
		int hangs;
		if (side_of(m, at, &r[i], &hangs) != interval[i] - r[i].held) {
			agreed = 0;
		} else if (hangs) {
			agreed = 1;
		}
	}
	return agreed;
}

/* More than MOST of them, in `interval`, by block pivoting: all that do not agree change over together while that
 * leaves fewer of them, else the first of them alone, which ends where the Delassus matrix is a P-matrix.  0:
 * they do not come to agree. */
static int pivot(const pl_events *m, pl_instant *at, const resting *r, int count, int *interval)
{
	enum { TURNS = 64, CHANCES = 4 };
	int fewest = count + 1, chances = CHANCES, turn, i;
	for (turn = 0; turn < TURNS * count; turn++) {
		int to[RESTING], wrong = 0, hangs;
		enter_all(m, at, r, count, interval);
		for (i = 0; i < count; i++) {
			to[i] = r[i].held + side_of(m, at, &r[i], &hangs);
			wrong += to[i] != interval[i];
		}
		if (wrong == 0) {
			return can_be(m, at);
		}
		chances = wrong < fewest ? CHANCES : chances - 1;
		fewest = wrong < fewest ? wrong : fewest;
		for (i = 0, wrong = 0; i < count && (chances > 0 || !wrong); i++) {
			wrong = to[i] != interval[i];
			interval[i] = to[i];
		}
	}
	return 0;
}

static int is_pressed(const pl_events *m, const pl_instant *at, int impact)
{
	const int hold = m->impact[impact].hold;
	int up, any = 0;
	for (up = 0; up < 2; up++) {
		if ((up ? m->hold[hold].up : m->hold[hold].down) >= 0) {
			const column w = pull_of(m, at, hold, up);
			if (!(certain(&w) < 0)) {
				return 0;
			}
			any = 1;
		}
	}
	return any;
}
