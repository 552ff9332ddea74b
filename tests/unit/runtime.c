/* SPDX-License-Identifier: MIT-0 */
/* All tests of the runtime of one type. PROGRAM [PATTERN]: those whose names match, as in 'phases_*' or apply_products.
 */
#include "runtime.h"

#define ADDRESS(name) &room_of_##name,
static const struct room *const rooms[] = {ROOMS(ADDRESS)};
enum { ROOM_COUNT = sizeof rooms / sizeof *rooms };

static char *case_name(const struct room *room, const struct CMUnitTest *test)
{
	const size_t size = strlen(room->name) + 1 + strlen(test->name) + 1;
	char *name = (char *)malloc(size);
	if (!name)
		abort();
	snprintf(name, size, "%s_%s", room->name, test->name);
	return name;
}

int main(int argc, char **argv)
{
	static struct CMUnitTest tests[200];
	size_t count = 0, i, k;
	int status;
	for (i = 0; i < ROOM_COUNT; i++) {
		if (rooms[i]->start)
			rooms[i]->start();
		for (k = 0; k < rooms[i]->tests; k++) {
			if (count == sizeof tests / sizeof *tests)
				abort();
			tests[count] = rooms[i]->test[k];
			tests[count++].name = case_name(rooms[i], &rooms[i]->test[k]);
		}
	}
	if (argc > 1)
		cmocka_set_test_filter(argv[1]);
	/* cmocka's macro counts an array; here only the first `count` are there */
	status = _cmocka_run_group_tests("runtime", tests, count, NULL, NULL);
	for (i = 0; i < ROOM_COUNT; i++)
		if (rooms[i]->end)
			rooms[i]->end();
	for (i = 0; i < count; i++)
		free((char *)tests[i].name);
	mpfr_free_cache();
	return status;
}
