/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Words with a meaning of their own, and names that resemble a misspelt one. */
#include "plgen.h"

#include <string.h>
#include <strings.h>
#include <strings.h>

static const char *const function_names[] = {
	"", "sin", "cos", "tan", "exp", "log", "sqrt", "abs", "sgn", "sinh", "cosh", "tanh",
	"asin", "acos", "atan", "atan2", "min", "max", "deadzone", "clip", "table"
};

static const char *const words[] = {
	/* statements */
	"model", "param", "coord", "init", "let", "input", "output", "matrix", "mass", "spring", "damper", "force", "step", "scheme", "operator",
	"tunable",
	/* the language */
	"t", "pi", "at", "hold", "first", "between", "on", "ground"
};

/* C99, C11, C++17 keywords and alternative tokens */
static const char *const keywords[] = {
	"alignas", "alignof", "and", "and_eq", "asm", "auto", "bitand", "bitor", "bool", "break", "case", "catch", "char", "char16_t",
	"char32_t", "class", "compl", "const", "const_cast", "constexpr", "continue", "decltype", "default", "delete", "do", "double",
	"dynamic_cast", "else", "enum", "explicit", "export", "extern", "false", "float", "for", "friend", "goto", "if", "inline", "int",
	"long", "mutable", "namespace", "new", "noexcept", "not", "not_eq", "nullptr", "operator", "or", "or_eq", "private", "protected",
	"public", "register", "reinterpret_cast", "restrict", "return", "short", "signed", "sizeof", "static", "static_assert",
	"static_cast", "struct", "switch", "template", "this", "thread_local", "throw", "true", "try", "typedef", "typeid", "typename",
	"typeof", "union", "unsigned", "using", "virtual", "void", "volatile", "wchar_t", "while", "xor", "xor_eq"
};

/* External names and types of the C library (C99 and the POSIX ones that a host links anyway) that a model's type or
 * functions could meet. */
static const char *const library[] = {
	"abort", "abs", "access", "acos", "acosh", "alarm", "asctime", "asin", "asinh", "assert", "atan", "atan2", "atanh", "atexit", "atof",
	"atoi", "atol", "atoll", "bind", "brk", "bsearch", "cabs", "calloc", "carg", "cbrt", "ceil", "cexp", "chdir", "cimag", "clearerr",
	"clock", "clock_t", "close", "complex", "conj", "connect", "copysign", "cos", "cosh", "creal", "ctime", "difftime", "div", "div_t",
	"double_t", "dup", "environ", "erf", "erfc", "errno", "exit", "exp", "exp2", "expm1", "fabs", "fclose", "fdim", "feof", "ferror",
	"fflush", "fgetc", "fgets", "float_t", "floor", "fma", "fmax", "fmin", "fmod", "fopen", "fork", "fprintf", "fputc", "fputs", "fread",
	"free", "freopen", "frexp", "fscanf", "fseek", "ftell", "fwrite", "gamma", "getc", "getchar", "getenv", "gets", "gmtime", "hypot",
	"ilogb", "imaginary", "index", "int16_t", "int32_t", "int64_t", "int8_t", "intmax_t", "intptr_t", "isalnum", "isalpha", "isdigit",
	"isfinite", "isinf", "isnan", "isspace", "j0", "j1", "jn", "kill", "labs", "ldexp", "ldiv", "lgamma", "link", "llabs", "llrint",
	"llround", "localtime", "log", "log10", "log1p", "log2", "logb", "longjmp", "lrint", "lround", "main", "malloc", "max_align_t",
	"memchr", "memcmp", "memcpy", "memmove", "memset", "mktime", "modf", "nan", "nearbyint", "nextafter", "noreturn", "offsetof",
	"open", "pause", "perror", "pipe", "poll", "pow", "printf", "ptrdiff_t", "putc", "putchar", "puts", "qsort", "raise", "rand",
	"random", "read", "realloc", "remainder", "remove", "rename", "rewind", "rindex", "rint", "round", "scalb", "scalbn", "scanf",
	"select", "send", "setbuf", "setjmp", "setvbuf", "signal", "signbit", "sin", "sinh", "size_t", "sleep", "socket", "sprintf", "sqrt",
	"srand", "srandom", "sscanf", "stat", "std", "stderr", "stdin", "stdout", "strcat", "strchr", "strcmp", "strcpy", "strlen",
	"strncat", "strncmp", "strncpy", "strstr", "strtod", "strtok", "strtol", "sync", "system", "tan", "tanh", "tgamma", "time",
	"time_t", "times", "tmpfile", "tmpnam", "tolower", "toupper", "trunc", "uint16_t", "uint32_t", "uint64_t", "uint8_t", "uintmax_t",
	"uintptr_t", "ungetc", "unlink", "va_list", "vfprintf", "vprintf", "vsprintf", "wait", "write", "y0", "y1", "yn"
};

static bool listed(const char *name, const char *const *list, size_t count)
{
	for (size_t i = 0; i < count; i++)
		if (strcmp(name, list[i]) == 0)
			return true;
	return false;
}
#define LISTED(name, list) listed(name, list, sizeof (list) / sizeof *(list))

size_t name_hash(const char *name)
{
	size_t hash = 0;
	for (; *name; name++)
		hash = (hash ^ (unsigned char)*name) * 0x9e3779b97f4a7c15u;
	return hash >> 20;
}

const char *function_name(enum function function)
{
	return function_names[function];
}

enum function function_of(const char *name)
{
	for (int f = FN_SIN; f <= FN_TABLE; f++)
		if (strcmp(name, function_names[f]) == 0)
			return (enum function)f;
	return FN_NONE;
}

bool is_reserved(const char *name)
{
	return LISTED(name, words) || LISTED(name, keywords) || function_of(name) != FN_NONE;
}

const char *prefix_objection(const char *name)
{
	if (strcmp(name, "pl") == 0 || strncmp(name, "pl_", 3) == 0 || strcasecmp(name, "plrt") == 0)
		return "is kept for the runtime";
	if (LISTED(name, library))
		return "is a name of the C library";
	if (is_reserved(name))
		return "is a reserved word";
	if (name[0] == '_')
		return "starts with _, which C keeps for itself,";
	if (may_be_macro(name))
		return "is or may be a macro of C";
	return NULL;
}

static int least(int a, int b, int c)
{
	int ab = a < b ? a : b;
	return ab < c ? ab : c;
}

/* Number of letters to insert, remove, replace or swap with their neighbour to make `a` into `b` (Damerau), if it is below
 * `limit`; else it is no less. */
static int edit_distance(const char *a, const char *b, int limit)
{
	int m = (int)strlen(a), n = (int)strlen(b);
	if (m > 64 || n > 64 || m - n >= limit || n - m >= limit)
		return 64;
	int d[65][65], before = 0, row = 0;     /* the least of the last two rows */
	for (int i = 0; i <= m; i++) {
		if (i > 1 && before >= limit && row >= limit)
			return 64;
		before = row;
		row = 64;
		for (int j = 0; j <= n; j++) {
			if (i == 0 || j == 0) {
				d[i][j] = i + j;
				row = d[i][j] < row ? d[i][j] : row;
				continue;
			}
			int replace = d[i - 1][j - 1] + (a[i - 1] != b[j - 1]);
			d[i][j] = least(d[i - 1][j] + 1, d[i][j - 1] + 1, replace);
			if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && d[i - 2][j - 2] + 1 < d[i][j])
				d[i][j] = d[i - 2][j - 2] + 1;
			row = d[i][j] < row ? d[i][j] : row;
		}
	}
	return d[m][n];
}

const char *nearest_name(const char *name, int count, const char *const *known)
{
	const char *best = NULL;
	int distance = (int)strlen(name) <= 2 ? 2 : 3;
	for (int i = 0; i < count; i++) {
		int d = edit_distance(name, known[i], distance);
		if (d > 0 && strcasecmp(name, known[i]) == 0)
			return known[i];
		if (d > 0 && d < distance && d < (int)strlen(name)) {
			best = known[i];
			distance = d;
		}
	}
	return best;
}

const char *spec_suggestion(const struct spec *spec, const char *name)
{
	int count = 0, room = (int)(sizeof words / sizeof *words) + FN_TABLE;
	for (const struct symbol *s = spec->first; s; s = s->next)
		room++;
	const char **known = ARRAY(const char *, (size_t)room);
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->kind != SYMBOL_OUTPUT)
			known[count++] = s->name;
	for (int f = FN_SIN; f <= FN_TABLE; f++)
		known[count++] = function_names[f];
	const char *best = nearest_name(name, count, known);
	return best ? format("did you mean '%s'?", best) : NULL;
}
