/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "tap.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

static int results, failures, complaints;

bool ok(bool good, const char *name, ...)
{
    va_list arguments;
    va_start(arguments, name);
    printf("%s %d - ", good ? "ok" : "not ok", ++results);
    vprintf(name, arguments);
    putchar('\n');
    va_end(arguments);
    failures += !good;
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
        printf(": found %.17g, expected %.17g, difference %.3g, tolerance %.3g\n", found, expected, found - expected, tolerance);
    }
    return good;
}

int tap_end(void)
{
    printf("1..%d\n", results);
    return failures != 0;
}
