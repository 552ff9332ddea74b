/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tap.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int results, failures, complaints;

/* Whether a result is one of those that CASE=TEXT in the environment asks for: those with TEXT in their name */
static bool chosen(const char *name, va_list arguments)
{
	const char *part = getenv("CASE");
	char whole[1000];
	va_list again;
	va_copy(again, arguments);
	vsnprintf(whole, sizeof whole, name, again);
	va_end(again);
	return !part || strstr(whole, part);
}

bool ok(bool good, const char *name, ...)
{
	va_list arguments;
	va_start(arguments, name);
	if (chosen(name, arguments)) {
		printf("%s %d - ", good ? "ok" : "not ok", ++results);
		vprintf(name, arguments);
		putchar('\n');
		failures += !good;
		if (!good)
			fflush(stdout);             /* who waits for the first one ends the test there */
	}
	va_end(arguments);
	complaints = 0;
	return good;
}

void note(const char *text, ...)
{
	va_list arguments;
	va_start(arguments, text);
	fputs("# ", stdout);
	vprintf(text, arguments);
	putchar('\n');
	va_end(arguments);
}

bool close_to(double found, double expected, double tolerance, const char *what, ...)
{
	enum { COMPLAINTS = 10 };           /* of one test that are printed */
	const bool good = fabs(found - expected) <= tolerance;
	if (!good && complaints++ < COMPLAINTS) {
		va_list arguments;
		va_start(arguments, what);
		fputs("# ", stdout);
		vprintf(what, arguments);
		va_end(arguments);
		printf(": found %.17g, expected %.17g, difference %.3g, tolerance %.3g\n", found, expected,
				found - expected,
			tolerance);
	}
	return good;
}

bool is_close(double found, double expected, double tolerance, const char *what, ...)
{
	char name[200];
	va_list arguments;
	va_start(arguments, what);
	vsnprintf(name, sizeof name, what, arguments);
	va_end(arguments);
	return ok(close_to(found, expected, tolerance, "%s", name), "%s", name);
}

int tap_end(void)
{
	if (results == 0) {
		puts("Bail out! no case");
		return 99;
	}
	printf("1..%d\n", results);
	return failures != 0;
}
