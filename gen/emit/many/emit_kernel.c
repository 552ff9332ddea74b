/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_kernel, kernel.h: the step and the outputs of lanes, of which a work item of a device has one; or NAME_step with
 * all that it calls, whose C is printed again as that of the device. */
#define _GNU_SOURCE     /* open_memstream */
#include "inner.h"
#include "emit/printed.h"
#include "step/linear/rows.h"

#include <stdlib.h>
#include <string.h>

static const char *const words_of_opencl =
	"#pragma OPENCL FP_CONTRACT OFF\n"
	"#  define PL_LANES_INLINE static\n";
static const char *const words_of_cuda = "#  define PL_LANES_INLINE static __device__ inline\n";
static const char *const words_of_openmp = "#  define PL_LANES_INLINE static inline\n";

bool is_whole_on_device(const struct emitter *e)
{
	const struct batch b = e->step->no.lanes ? (struct batch){ .e = e } : plan_batch(e);
	return takes_whole_steps(&b);
}

/* What all targets are told */
static void say_target(const struct emitter *e, const char *target)
{
	const bool opencl = strcmp(target, "opencl") == 0, cuda = strcmp(target, "cuda") == 0;
	say(e, "\n"
	       "/* For %s: a work item steps one instance. The host is the C of plgen --batch: it has the arrays, and\n"
	       " * what all share comes from $n_batch_share. Bits are those of $n_batch where products are not\n"
	       " * contracted%s. */\n", opencl ? "OpenCL" : cuda ? "CUDA" : "OpenMP",
	    cuda ? " (nvcc -fmad=false)" : "");
}

void emit_whole_kernel(const struct emitter *e, const char *target)
{
	const bool opencl = strcmp(target, "opencl") == 0, cuda = strcmp(target, "cuda") == 0;
	const struct batch b = e->step->no.lanes ? (struct batch){ .e = e } : plan_batch(e);
	say_target(e, target);
	say(e, "enum { $N_BATCH_ROWS = %s, $N_BATCH_SHARED = %s };\n", row_count(e), shared_row_text(&b));
	emit_factor_places(&b);
	emit_sizes(e, "kernel.h", { "STATES", e->system->states }, { "INPUTS", inputs_of(e) },
		   { "OUTPUTS", e->model->outputs }, { "OVER", e->step->no.lanes ? 0 : steps_of_series(e) },
		   { "STEPPED", e->step->no.lanes ? 0 : batch_stepped_rows(e) }, { "LANES", b.factors },
		   { "EVENTS", !e->step->no.lanes && has_regions(e) },
		   { "PEAKS", e->step->no.lanes ? 0 : peak_outputs(e->model) },
		   { "OPENCL", opencl }, { "CUDA", cuda }, { "WHOLE", 1 });
	say_macro(e, "ROWS", spell(e, "$N_BATCH_ROWS"));
	say_macro(e, "SHARED", spell(e, "$N_BATCH_SHARED"));
	say_macro(e, "HEAD", format("(int)(%s)", shared_head_text(e)));
	say(e, "%s#include \"kernel.h\"\n", opencl || cuda ? "" : "#pragma omp end declare target\n");
}

/* NAME_flush, on what an instance keeps of its states */
static void emit_kernel_flush(const struct emitter *e, const char *function, const char *bits)
{
	const char *low = e->step->program->compensated ? format(", low[%d]", e->system->states) : "";
	if (!e->step->linear.flush)
		return;
	say(e, "typedef struct $n_flushed { double y[%d]%s; } $n_flushed;\n", e->system->states, low);
	begin_flush(e);
	say_macro(e, "TYPE", spell(e, "$n_flushed"));
	say_macro(e, "APART", "");
	say_macro(e, "FLUSH_FUNCTION", function);
	say_macro(e, "FLUSH_BITS", bits);
	say(e, "#include \"flush.h\"\n");
}

void emit_kernel(const struct emitter *e, const char *target)
{
	const bool opencl = strcmp(target, "opencl") == 0, cuda = strcmp(target, "cuda") == 0;
	const bool openmp = !opencl && !cuda;
	struct emitter on_device = *e;
	on_device.device = opencl ? "__constant" : cuda ? "static __device__ const" : "static const";
	struct batch b = plan_batch(&on_device);
	say_target(e, target);
	say(e, "%s%s#  define pl_lanes_all(value) (value)\n"
	       "typedef double pl_lanes;\n",
	    opencl && !e->model->request.single ? "#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n" : "",
	    opencl ? words_of_opencl : cuda ? words_of_cuda : words_of_openmp);
	say(e, "%s", openmp ? "#pragma omp declare target\n" : "");
	emit_kernel_flush(&on_device, cuda ? "__device__" : "", e->model->request.single ? "unsigned"
			  : opencl ? "ulong" : "unsigned long long");
	say(e, "%s", openmp ? "#pragma omp end declare target\n" : "");
	emit_sizes(e, "kernel.h", { "STATES", e->system->states }, { "OVER", steps_of_series(e) },
		   { "STEPPED", batch_stepped_rows(e) }, { "OUTPUTS", e->model->outputs },
		   { "ROWS", batch_stepped_rows(e) }, { "WHOLE", 0 }, { "SHARED", b.shared },
		   { "LANES", b.lanes }, { "OPENCL", opencl }, { "CUDA", cuda },
		   { "FLUSHES", e->step->linear.flush != NULL });
	say(e, "#include \"kernel.h\"\n");
	say(e, "%s", openmp ? "#pragma omp declare target\n" : "");
	if (has_series(e))
		emit_kernel_of_series(&b);
	else
		emit_lanes_step(&b);
	emit_lanes_out(&b);
	say(e, "%s", openmp ? "#pragma omp end declare target\n" : "");
}

/* ---- C as that of a device ---- */

/* OpenCL C has neither headers nor __global tables before generic pointers; there all memory of a processor is one. */
static const char opencl_begin[] =
	"#ifdef cl_khr_fp64\n"
	"#pragma OPENCL EXTENSION cl_khr_fp64 : enable\n"
	"#endif\n"
	"#pragma OPENCL FP_CONTRACT OFF\n"
	"#ifdef __clang__\n"
	"#pragma clang diagnostic ignored \"-Wconstant-logical-operand\"\n"
	"#endif\n"
	"#if (defined __opencl_c_generic_address_space && defined __opencl_c_program_scope_global_variables) || \\\n"
	"    __OPENCL_C_VERSION__ == 200\n"
	"#define PL_TABLE static __global const\n"
	"#define PL_PLACE(table) (table)\n"
	"#elif defined PL_POINTERS_APART\n"
	"#error \"this compiler of OpenCL C has no generic pointers, and the device no others that reach all memory\"\n"
	"#else /* of a processor, whose pointers are all alike */\n"
	"#define PL_TABLE __constant\n"
	"#define PL_PLACE(table) (ulong)(table)\n"
	"#endif\n"
	"typedef uchar uint8_t;\n"
	"typedef int int32_t;\n"
	"typedef uint uint32_t;\n"
	"typedef long int64_t;\n"
	"typedef ulong uint64_t;\n"
	"#define UINT64_C(number) number##ul\n"
	"#define INT64_C(number) number##l\n"
	"#define UINT64_MAX (~(ulong)0)\n"
	"#define INT64_MAX ((long)(~(ulong)0 >> 1))\n"
	"#define INT64_MIN (-INT64_MAX - 1)\n"
	"#ifndef NULL\n"
	"#define NULL ((void *)0)\n"
	"#endif\n"
	"#define offsetof(type, member) __builtin_offsetof(type, member)\n"
	"#define inline\n"
	"#define half the_half /* words of OpenCL C */\n"
	"#define constant the_constant\n"
	"#define global the_global\n"
	"#define local the_local\n"
	"#define private the_private\n"
	"#define generic the_generic\n"
	"#define kernel the_kernel\n"
	"#define pipe the_pipe\n";
static const char cuda_begin[] =
	"#include <float.h>\n#include <stddef.h>\n#include <stdint.h>\n";
static const char openmp_begin[] =
	"#include <float.h>\n#include <stddef.h>\n#include <stdint.h>\n"
	"#ifdef __GNUC__\n#pragma GCC diagnostic ignored \"-Wunused-function\"\n"
	"#pragma GCC diagnostic ignored \"-Wunused-const-variable\"\n#endif\n"
	"#pragma omp declare target\n";

static bool begins(const char *line, const char *with)
{
	return strncmp(line, with, strlen(with)) == 0;
}

/* static const TYPE NAME[...] = ...: what is read of it stands where NAME did. Returns behind the `=` */
static const char *put_table(FILE *to, const char *line)
{
	const char *type = strstr(line, "const ") + strlen("const "), *end = line + strcspn(line, "=");
	const char *size = line + strcspn(line, "[=");
	const char *name = *size == '[' ? size : end - 1;
	while (!in_name(name[-1]))
		name--;
	const char *behind_name = name;
	while (in_name(name[-1]))
		name--;
	const int length = (int)(behind_name - name), of_type = (int)(name - type);
	const char *shape = *size == '[' ? format("(*)%.*s", (int)(end - 1 - size), size) : "*";
	fprintf(to, "#define %.*s (*(const %.*s%s)PL_PLACE(&%.*s_table))\n", length, name, of_type, type, shape, length,
		name);
	fprintf(to, "PL_TABLE %.*s_table%.*s", of_type + length, type, (int)(end - behind_name), behind_name);
	return end;
}

static bool is_table(const char *line)
{
	const bool constant = begins(line + strspn(line, " "), "static const ") || begins(line, "const ");
	return constant && line[strcspn(line, "=(;\n")] == '=';
}

/* The head of a function: arrays among its parameters are pointers, which OpenCL C takes for generic ones */
static const char *put_head(FILE *to, const char *text)
{
	int depth = 0;
	for (const char *end; *text && *text != '{' && *text != ';'; text = end) {
		const char *quoted = behind_quoted(text, false);
		const size_t length = quoted ? 0 : name_length(text);
		end = quoted ? quoted : text + (length ? length : 1);
		const bool array = depth > 0 && length && *end == '[';
		const char *more = array ? end + strcspn(end, "]") + 1 : end;
		depth += (*text == '(') - (*text == ')');
		if (!array)
			put(to, text, (size_t)(end - text));
		else
			fprintf(to, *more == '[' ? "(*%.*s)" : "*%.*s", (int)length, text);
		for (end = more; array && *end == '['; end = more) {
			more = end + strcspn(end, "]") + 1;
			put(to, end, (size_t)(more - end));
		}
	}
	return text;
}

/* All that begins with `from`, up to `last`, as `to` */
static const char *replaced(const char *text, const char *from, char last, const char *to)
{
	char *made = NULL;
	size_t size = 0;
	FILE *out = need_memory(open_memstream(&made, &size));
	for (const char *at; (at = strstr(text, from)); text = last ? behind(at, last) : at + strlen(from)) {
		put(out, text, (size_t)(at - text));
		fputs(to, out);
	}
	fputs(text, out);
	fclose(out);
	const char *kept = format("%s", (char *)need_memory(made));
	free(made);
	return kept;
}

/* OpenCL C has no pointers to functions: each is one function of the model, whose declaration comes first */
static const char *without_pointers(const char *text, const char *name)
{
	const char *again = format("%s_again(", name), *at = strstr(text, format("static void %s", again));
	const char *declared = at ? format("%.*s;\n", (int)(strchr(at, ')') + 1 - at), at) : "";
	const char *f = strstr(text, "pl_cachedf") ? "f" : "", *matrix = format("pl_cached%s_matrix", f);
	if (!strstr(text, format("int %s(", matrix)))
		declared = format("%s#define %s(cached, region) 0\n", declared, matrix);
	text = replaced(text, "    int (*matrix)(struct", ';', "");
	text = replaced(text, "    void (*expand)(", ';', "");
	text = replaced(text, format("%s, ", matrix), 0, "");
	text = replaced(text, "m->cached->matrix(", 0, format("%s(", matrix));
	text = replaced(text, "p->at.expand =", ';', "");
	text = replaced(text, "m->at.expand =", ';', "");
	text = replaced(text, "\nPL_ASSERT(", ';', "\n");
	text = replaced(text, "at->expand(", 0, again);
	return format("%s%s", declared, text);
}

/* In its first column what declares a function, of which the model's have names for others, too */
static bool is_function(const char *line, const char *kernel)
{
	static const char *const other[] = { "typedef", "enum", "struct", "union", "extern", "__", "PL_ASSERT",
					     "static const" };
	const char *end = line + strcspn(line, "(=;{\n");
	bool any = in_name(*line) && *end == '(';
	for (size_t i = 0; i < sizeof other / sizeof *other; i++)
		any = any && (!begins(line, other[i]) || (i > 6 && *end == '('));
	return any && !strstr(format("%.*s", (int)(end - line), line), kernel);
}

static void print_device(FILE *to, const char *text, const char *name, const char *first, const char *words)
{
	const char *kernel = format("%s_kernel", name);
	const bool tables = first == opencl_begin;
	bool begun = false;
	/* what looks at flags of a host's compiler calls what is defined nowhere */
	text = replaced(text, "#if defined __clang__ && defined __OPTIMIZE__", 0, "#if 0");
	for (const char *line = text, *end; *line; line = end) {
		end = behind_quoted(line, true);
		end = end && *end == '\n' ? end + 1 : end;
		const char *next = line + strcspn(line, "\n");
		next += *next == '\n';
		fputs(*line == '#' && !begun ? first : "", to);
		begun = begun || *line == '#';
		if (begins(line, "#include <") || begins(line, "extern const ")) {
			end = next;
		} else if (end) {
			put(to, line, (size_t)(end - line));
		} else if (tables && *line == ' ' && is_table(line)) {
			end = strstr(line, "const ");           /* in a function there are none */
			fprintf(to, "    %.*s", (int)(next - end), end);
			end = next;
		} else if (tables && is_table(line)) {
			end = put_table(to, line);
			next = end + strcspn(end, "\n");
			next += *next == '\n';
			put(to, end, (size_t)(next - end));
			end = next;
		} else if (is_function(line, kernel)) {
			fputs(words, to);
			end = line + (begins(line, "static ") ? strlen("static ") : 0);
			end = tables ? put_head(to, end) : end;
			next = end + strcspn(end, "\n");
			next += *next == '\n';
			put(to, end, (size_t)(next - end));
			end = next;
		} else if (is_table(line)) {
			end = strstr(line, "const ");
			fprintf(to, "%.*s%s%.*s", (int)strspn(line, " "), line, words, (int)(next - end), end);
			end = next;
		} else {
			put(to, line, (size_t)(next - line));
			end = next;
		}
	}
}

void print_opencl(FILE *to, const char *text, const char *name)
{
	print_device(to, without_pointers(text, name), name, opencl_begin, "static ");
}

void print_cuda(FILE *to, const char *text, const char *name)
{
	print_device(to, text, name, cuda_begin, "static __device__ ");
}

void print_openmp(FILE *to, const char *text, const char *name)
{
	print_device(to, text, name, openmp_begin, "static ");
}
