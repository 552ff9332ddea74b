/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The C of a model as code in memory, by libtcc: a compiler of a millisecond, which rounds each product and each sum as
 * it is written. It reads no file and needs none. */
#include "run_texts.h"
#include "emit/emit.h"
#include "run/run.h"

#include <libtcc.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>


/* ---- the text ---- */

static void print_text_of(FILE *to, const char *name)
{
	for (size_t i = 0; i < sizeof texts / sizeof *texts; i++)
		if (strcmp(texts[i].name, name) == 0)
			fputs(texts[i].text, to);
}

/* A text that is being printed */
struct printing { FILE *to; char *text; size_t length; };

static void start_text(struct printing *p)
{
	p->to = need_memory(open_memstream(&p->text, &p->length));
}

static char *text_printed(struct printing *p)
{
	fclose(p->to);
	return need_memory(p->text);
}

/* Another text made of one, which is freed */
static char *rewritten(char *text, rewriter *print, const char *name)
{
	struct printing p;
	start_text(&p);
	print(p.to, text, name);
	free(text);
	return text_printed(&p);
}

/* What nobody calls here is left out: batches, the selftest. */
static char *model_text(const struct step *step, enum running_with with)
{
	struct step tangent = *step;
	struct model model = *step->model;
	struct printing p;
	model.request.many.batch = model.request.selftest = model.request.own_math = false;
	tangent.model = &model;
	start_text(&p);
	if (with & WITH_COUNTS)                 /* as a Cortex-M4 takes its steps: see search.h */
		fputs("#define PL_AS_ON_BOARDS 1\n", p.to);
	emit_code(p.to, &tangent, "", NULL, with & WITH_RHS);
	char *text = rewritten(text_printed(&p), print_included, model.name);
	if (model.request.single)
		text = rewritten(text, print_single, model.name);
	text = rewritten(text, print_apart, model.name);
	return with & WITH_COUNTS ? rewritten(text, print_counts, model.name) : text;
}

/* A header of the runtime, with those in it that it includes */
static void print_header(FILE *to, const char *name)
{
	char other[64];
	for (const char *line = runtime_text(name), *end; *line; line = end) {
		end = line + strcspn(line, "\n");
		end += *end == '\n';
		if (sscanf(line, "#include \"%63[^\"]\"", other) == 1)
			print_header(to, other);
		else
			fprintf(to, "%.*s", (int)(end - line), line);
	}
}

/* Headers are in the text already. */
static char *without_includes(char *text)
{
	for (char *line = text; line; line = strchr(line, '\n')) {
		line += *line == '\n';
		if (strncmp(line, "#include", strlen("#include")) == 0)
			memcpy(line, "//", 2);
	}
	return text;
}

static char *text_of(const struct step *step, enum running_with with)
{
	char *model = model_text(step, with);
	struct printing p;
	start_text(&p);
	print_text_of(p.to, "prelude.h");
	fputs(math_prototypes, p.to);
	print_header(p.to, "plrt.h");
	if (with & WITH_COUNTS) {
		fprintf(p.to, "typedef %s pl_real;\n", step->model->request.single ? "float" : "double");
		print_text_of(p.to, "counts.h");
		fputs(math_counts, p.to);
	}
	fputs(model, p.to);
	free(model);
	return without_includes(text_printed(&p));
}

/* ---- the compiler ---- */

static void keep_message(void *to, const char *message)
{
	*(const char **)to = format("%s", message);
}

static bool compile(TCCState *tcc, const char *text)
{
	tcc_set_options(tcc, "-nostdlib -nostdinc -w");
	if (tcc_set_output_type(tcc, TCC_OUTPUT_MEMORY) < 0 || tcc_compile_string(tcc, text) < 0)
		return false;
	for (const struct runtime_symbol *s = runtime_symbols; s->name; s++)
		tcc_add_symbol(tcc, s->name, s->at);
	return true;
}

/* In pages of its own, until the end; later versions of the library have them, with the state */
static bool link_here(TCCState *tcc)
{
#ifndef TCC_RELOCATE_AUTO
	return tcc_relocate(tcc) >= 0;
#else
	const int size = tcc_relocate(tcc, NULL);
	if (size < 0)
		return false;
	void *room = mmap(NULL, (size_t)size, PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
	return room != MAP_FAILED && tcc_relocate(tcc, room) >= 0;
#endif
}

struct native native_of(struct place at, const struct step *step, enum running_with with)
{
	const char *name = outer_name(step->model), *message = "no memory that can run";
	char *text = text_of(step, with);
	TCCState *tcc = need_memory(tcc_new());
	struct native native = { 0 };
	tcc_set_error_func(tcc, &message, keep_message);
	const bool done = compile(tcc, text) && link_here(tcc);
	free(text);
	if (done) {
		const void *const *counts = tcc_get_symbol(tcc, "pl_counts");
		native = (struct native){ tcc_get_symbol(tcc, format("%s_model", name)),
					  tcc_get_symbol(tcc, format("%s_rhs", name)), counts ? *counts : NULL };
	}
#ifdef TCC_RELOCATE_AUTO
	tcc_delete(tcc);
#endif
	if (!native.model)
		error(at, NULL, "internal error: the C of the model cannot be run here: %s", message);
	return native;
}
