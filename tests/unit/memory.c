/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The two budgets of a spec: bytes that are held, and terms that were made so far. Who asks for more ends the program,
 * with a message; so each case is a process of its own. */
#include "draw.h"
#include "base/base.h"

#include <stdio.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

enum { MEGABYTE = 1 << 20, TEXT = 400 };

/* What `work` says on stderr; returns its exit status */
static int told(void (*work)(void), char text[TEXT])
{
	int ends[2], status;
	assert_int_equal(pipe(ends), 0);
	fflush(NULL);
	pid_t child = fork();
	assert_true(child >= 0);
	if (child == 0) {
		dup2(ends[1], STDERR_FILENO);
		close(ends[0]);
		close(ends[1]);
		work();
		_exit(0);
	}
	close(ends[1]);
	size_t length = 0;
	for (ssize_t got = 1; got > 0 && length + 1 < TEXT; length += got > 0 ? (size_t)got : 0)
		got = read(ends[0], text + length, TEXT - 1 - length);
	text[length] = 0;
	close(ends[0]);
	assert_int_equal(waitpid(child, &status, 0), child);
	return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static void assert_told(void (*work)(void), const char *wanted)
{
	char text[TEXT];
	int status = told(work, text);
	if (status != (wanted ? 1 : 0) || (wanted ? !strstr(text, wanted) : *text != 0))
		fail_msg("exit status %d, '%s'; expected %s%s", status, text, wanted ? "1 and " : "0", wanted ? wanted
				: "");
}

static void hold_most(void)
{
	allocate(LIMIT_BYTES / 10 * 9, 1);
}

static void hold_twice(void)
{
	hold_most();
	hold_most();
}

static void hold_one_after_the_other(void)
{
	for (int i = 0; i < 3; i++)
		discard(allocate(LIMIT_BYTES / 10 * 9, 1));
}

static void hold_at_once(void)
{
	allocate(LIMIT_BYTES / MEGABYTE + 1, MEGABYTE);
}

static void hold_rationals(void)
{
	hold_most();
	rationals(LIMIT_BYTES / 10 / 64);
}

static void bytes_that_are_held_count(void **state)
{
	(void)state;
	assert_told(hold_most, NULL);
	assert_told(hold_one_after_the_other, NULL);
	assert_told(hold_twice, "more memory than the limit");
	assert_told(hold_at_once, "more memory than the limit");
	assert_told(hold_rationals, "more memory than the limit");
}

static void spend_most(void)
{
	for (int i = 0; i < 9; i++)
		spend_terms(LIMIT_TERMS / 10);
}

static void spend_too_much(void)
{
	spend_most();
	spend_terms(LIMIT_TERMS / 10);
	spend_terms(1);
}

static void terms_made_so_far_count(void **state)
{
	(void)state;
	assert_told(spend_most, NULL);
	assert_told(spend_too_much, "more terms than the limit");
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bytes_that_are_held_count),
		cmocka_unit_test(terms_made_so_far_count),
	};
	choose_cases(argc, argv);
	memory_open();
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return status;
}
