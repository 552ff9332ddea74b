/* SPDX-License-Identifier: GPL-3.0-or-later */
/* C as emitters print it, with braces around bodies, and with counts: what comes out is written here by hand. */
#include "run/run.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>

#include <cmocka.h>

static void becomes_by(rewriter *print, const char *text, const char *expected)
{
	char *made = NULL;
	size_t length;
	FILE *to = open_memstream(&made, &length);
	assert_non_null(to);
	print(to, text, "model");
	fclose(to);
	assert_string_equal(made, expected);
	free(made);
}

static void becomes(const char *text, const char *expected)
{
	becomes_by(print_braces, text, expected);
}

static void bodies_get_braces(void **state)
{
	(void)state;
	becomes("void f(int n)\n{\n    for (i = 0; i < n; i++)\n        x[i] = 0;\n}\n",
		"void f(int n)\n{\n    for (i = 0; i < n; i++) {\n        x[i] = 0;\n    }\n}\n");
	becomes("void f(void)\n{\n    while (g(1, (2)))\n        h();  /* twice; */\n    k();\n}\n",
		"void f(void)\n{\n    while (g(1, (2))) {\n        h();  /* twice; */\n    }\n    k();\n}\n");
	becomes("int f(int a)\n{\n    if (a &&\n        b)  /* if ( */\n        return 1;\n}\n",
		"int f(int a)\n{\n    if (a &&\n        b) {  /* if ( */\n        return 1;\n    }\n}\n");
	becomes("void f(void)\n{\n    if (a) return;\n    do x++; while (x < 3);\n}\n",
		"void f(void)\n{\n    if (a) {\n        return;\n    }\n    do {\n        x++;\n"
		"    } while (x < 3);\n}\n");
}

static void an_else_stays_with_its_if(void **state)
{
	(void)state;
	becomes("void f(void)\n{\n    if (a)\n        if (b)\n            x = 1;\n        else\n"
		"            x = 2;\n}\n",
		"void f(void)\n{\n    if (a) {\n        if (b) {\n            x = 1;\n        } else {\n"
		"            x = 2;\n        }\n    }\n}\n");
	becomes("void f(void)\n{\n    if (a)\n        x = 1;\n    else if (b)\n        x = 2;\n    else {\n"
		"        x = 3;\n    }\n    if (c) {\n        x = 4;\n    } else\n        x = 5;\n}\n",
		"void f(void)\n{\n    if (a) {\n        x = 1;\n    } else if (b) {\n        x = 2;\n    } else {\n"
		"        x = 3;\n    }\n    if (c) {\n        x = 4;\n    } else {\n        x = 5;\n    }\n}\n");
}

static void loops_stand_in_each_other(void **state)
{
	(void)state;
	becomes("void f(void)\n{\n    for (;;)\n        for (;;)\n            if (a)\n                break;\n"
		"    x = 0;\n}\n",
		"void f(void)\n{\n    for (;;) {\n        for (;;) {\n            if (a) {\n                break;\n"
		"            }\n        }\n    }\n    x = 0;\n}\n");
	becomes("void f(void)\n{\n    switch (a) {\n    case 0:\n        if (b)\n            x = 1;\n        break;\n"
		"    default: x = 2;\n    }\n}\n",
		"void f(void)\n{\n    switch (a) {\n    case 0:\n        if (b) {\n            x = 1;\n        }\n"
		"        break;\n    default: x = 2;\n    }\n}\n");
}

static void nothing_else_changes(void **state)
{
	static const char *const text[] = {
		"#if A && \\\n    B\n#define f(x) if (x) g()\n#endif\nextern \"C\" {\nint a[] = {1, 2};\n}\n",
		"/* if (a) b; { */\nstatic const char *const name[] = {\"if (\", \"}\"};\n",
		"struct s {\n    int (*f)(int a);\n};\nvoid f(void)\n{\n    const struct s t = {1, {2}};\n"
		"    for (i = 0; i < 3; i++) {\n        x = y;\n    }\n    iffy(else_what);\n}\n",
		"void f(void)\n{\n#if A\n    x = 1;\n#endif\n}",
		"#error \"not {\\\nif this\"\nint x;\n",
		""
	};
	(void)state;
	for (size_t i = 0; i < sizeof text / sizeof *text; i++)
		becomes(text[i], text[i]);
}

/* What is behind a sign is counted where it is evaluated: in branches, in brackets; of tables and places nothing is. */
static void counts_stand_before_operands(void **state)
{
	(void)state;
	becomes_by(print_counts,
		   "const double A[] = {1.0 / 3.0};\nvoid f(int n)\n{\n    x = a ? b * -c[i + 1] : d;\n}\n",
		   "const double A[] = {1.0 / 3.0};\nvoid f(int n)\n{\n"
		   "    x = a ? b * (PL_MULTIPLIES(b * -c[i + 1]), -c[i + 1]) : d;\n}\n");
	becomes_by(print_counts,
		   "int f(void)\n{\n    static const double t = 1.0 / 3.0;\n    *s->y += (real)n - g(x / 2e-1);\n}\n",
		   "int f(void)\n{\n    static const double t = 1.0 / 3.0;\n"
		   "    *s->y += (PL_ADDS(*s->y += (real)n - g(x / 2e-1)), (real)n "
		   "- (PL_ADDS((real)n - g(x / 2e-1)), g(x / (PL_MULTIPLIES(x / 2e-1), 2e-1))));\n}\n");
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(bodies_get_braces),
		cmocka_unit_test(an_else_stays_with_its_if),
		cmocka_unit_test(loops_stand_in_each_other),
		cmocka_unit_test(nothing_else_changes),
		cmocka_unit_test(counts_stand_before_operands),
	};
	return cmocka_run_group_tests_name("braces", tests, NULL, NULL);
}
