% SPDX-License-Identifier: MIT-0
% plgen_model: a model of plgen in Octave, by the calls of the Python package.
%
%     mkoctfile --mex -Iruntime host/octave/plgen_mex.c     % once; plgen_mex.mex beside this file or on the path
%
%     m = plgen_model("own.spec", "k", 60);   % a file, or the text of a spec; params by name
%     y = m.run(1000);                        % rows x outputs: now, and after each step; m.t has their times
%     m.retune("k", 70);                      % a tunable param: nothing is compiled
%
% m.run(u) takes a record, rows x inputs. m.params, m.states, m.inputs, m.outputs are names and values, m.state the
% states, m.time the time. Errors have plgen's message. An object is a handle: m.copy() is another instance. Options
% before the params: "-step", 0.01, "-real", "float", "-options", "--scheme etdrk4".
classdef plgen_model < handle
	properties (SetAccess = private)
		name = ""; states = {}; inputs = {}; outputs = {}; tunable = {};
		h = 0; t = [];
	end
	properties (Access = private)
		spec = ""; text = ""; options = ""; asked = [];     % asked: the step on the command line
		given = struct(); tuned = []; code = []; bytes = uint8([]);
		fresh = true; tail = []; kept = false; told = [];
	end
	properties (Dependent)
		params; state; time; status; explain; Phi; ss;
	end
	methods
		function m = plgen_model(spec, varargin)
			if nargin == 0
				return                                      % for copy
			end
			m.spec = spec;
			if any(spec == "\n")
				m.text = spec;
				m.spec = "-";
			end
			while numel(varargin) >= 2 && varargin{1}(1) == "-"
				switch varargin{1}
				case "-step", m.asked = varargin{2};
				case "-real", m.options = [m.options, " --real ", quoted(varargin{2})];
				case "-options", m.options = [m.options, " ", varargin{2}];
				otherwise, fail(["unknown option ", varargin{1}]);
				end
				varargin = varargin(3:end);
			end
			build(m, named(varargin), m.asked);
		end

		function other = copy(m)
			other = plgen_model();
            adopt(other, m, {"name", "states", "inputs", "outputs", "tunable", "h", "t", "spec", "text", "options", ...
                             "asked", "given", "tuned", "code", "bytes", "fresh", "tail", "kept", "told"});
		end

		% ---- where it is ----

		function y = get.state(m)
			y = plgen_mex("get", m.code.id, m.bytes).';
		end
		function set.state(m, y)
			put(m, y);
		end
		function t = get.time(m)
			t = plgen_mex("time", m.code.id, m.bytes);
		end
		function s = get.status(m)
			s = plgen_mex("status", m.code.id, m.bytes);
		end
		function y = out(m)
			y = plgen_mex("out", m.code.id, m.bytes).';
		end
		function put(m, y, t)               % the states y, at the time t [s]
			if nargin < 3
				t = m.time;
			end
			m.bytes = plgen_mex("set", m.code.id, m.bytes, t, double(y(:)));
			begin(m);
		end
		function reset(m)                   % t = 0 and the initial values; params stay
			m.bytes = plgen_mex("init", m.code.id, uint8([]));
			if ! isequal(m.tuned, m.code.values) || m.h != m.code.h
				tune(m, m.tuned, m.h);
			end
			begin(m);
		end

		% ---- steps ----

		function y = step(m, u = [])        % one step, u as NAME_step takes it; the outputs
			[m.bytes, rows, ~, good] = plgen_mex("run", m.code.id, m.bytes, 1, double(u(:)));
			m.fresh = false;
			m.kept = false;
			if ! good
				fail(trouble(m));
			end
			y = rows.';
		end
		function hold(m, u)                 % the sample of ramps before the next step
			m.bytes = plgen_mex("hold", m.code.id, m.bytes, double(u(:)));
			m.fresh = false;
			m.kept = false;
		end
		function jump(m, n)                 % n steps at once
			m.bytes = plgen_mex("jump", m.code.id, m.bytes, n);
			m.fresh = false;
		end
		function y = at(m, tau, u = [])     % the states tau after now, 0 <= tau <= h
			need(tau >= 0 && tau <= m.h, "tau is not in 0 .. h");
			y = plgen_mex("at", m.code.id, m.bytes, tau, double(u(:))).';
		end

        % Steps: how many, or a record. From a fresh start (a new model, reset, a state set) the first row is now, and
		% with ramps the record starts there; else the run goes on, so pieces put together are one run.
		function y = run(m, u)
			first = m.fresh;
			y = zeros(0, numel(m.outputs));
			if isempty(m.inputs)
				n = u;
				need(isscalar(n) && n >= 0 && n == fix(n), "expected a number of steps");
				u = [];
			else
				u = record(m, u);
				n = rows(u);
			end
			t = [];
			if first
				y = m.out();
				t = m.time;
			end
			m.fresh = false;
			[m.bytes, more, times, good] = plgen_mex("run", m.code.id, m.bytes, n, double(u.'));
			y = [y; more.'];
			m.t = [t; times(1:good).'];
			if good < n
				fail(trouble(m));
			end
		end

		% ---- params ----

		function p = get.params(m)
			p = with_tuned(m, true(size(m.tunable)));
		end

        % Other values by name, "-step" among them; state and time stay. Only what is not tunable compiles a model.
		function retune(m, varargin)
			h = [];
			if numel(varargin) >= 2 && strcmp(varargin{1}, "-step")
				h = varargin{2};
				varargin = varargin(3:end);
			end
			p = named(varargin);
			if all(cellfun(@(n) isnumeric(p.(n)) && any(strcmp(n, m.tunable)), fieldnames(p))) && ...
					(isempty(h) || m.code.can_retune)
				values = m.tuned;
				for one = fieldnames(p).'
					values(strcmp(one{1}, m.tunable)) = p.(one{1});
				end
				h = [h, m.h](1);
				if ! isempty(fieldnames(p)) || h != m.h
					tune(m, values, h);
				end
			else
				all_of_them = changed(m);
				for one = fieldnames(p).'
					all_of_them.(one{1}) = p.(one{1});
				end
				if isempty(h)
					h = step_now(m);
				end
				build(m, all_of_them, h);
			end
			m.told = [];
		end

		% ---- what plgen tells ----

		function e = get.explain(m)
			if isempty(m.told)
				m.told = jsondecode(plgen(m, changed(m), step_now(m), "--explain=json"));
			end
			e = m.told;
		end
		function p = get.Phi(m)
			e = m.explain;
			if ! e.linear
                fail([m.name, ": not linear, so it has no Phi: it would leave out ", strjoin(e.left_out, "; ")]);
			end
			p = e.Phi;
		end
		function s = get.ss(m)
			s = state_space(m);
		end

        % A, B, C, D (B1, D1 of u' where it acts) over the inputs, or with loads = true over the spec's loads; discrete:
        % those of a step over which u is held, or []. at: of a model that is not linear, where: "rest" (the default;
        % then a warning says so), "now", or states, "x=0.1,v=2"; s.at says it, and x, u, y are deviations from there
		function s = state_space(m, loads = false, at = "")
			s = wide_space(m, loads, at);
			if ! isempty(s.delays)
                fail([m.name, ": inputs are delayed, so it has no state space over them: it would leave out ", ...
					  strjoin({s.delays.input}, ", "), "; response counts them"]);
			end
			s = rmfield(s, "delays");
		end

		function [A, B, C, D] = linearise(m, at = "rest")
			s = state_space(m, false, at);
			[A, B, C, D] = {s.A, s.B, s.C, s.D}{:};
		end

		function p = poles(m, at = "")              % [1/s], each as often as it is there
			p = [];
			for one = equations(m, at).poles(:).'
				p = [p; repmat(complex(one.re, one.im), one.multiplicity, 1)];
			end
		end

		% Outputs x inputs x f [Hz], complex; u(t - d) counts as e^(-2 pi i f d) u
		function r = response(m, f, loads = false, at = "")
			s = wide_space(m, loads, at);
			r = zeros(rows(s.C), columns(s.B), numel(f));
			for k = 1:numel(f)
				p = 2i * pi * f(k);
				r(:, :, k) = s.C * ((p * eye(rows(s.A)) - s.A) \ (s.B + p * s.B1)) + s.D + p * s.D1;
				for late = s.delays(:).'
					one = strcmp(s.inputs, late.of);
					r(:, one, k) += exp(-p * late.delay) * r(:, strcmp(s.inputs, late.input), k);
				end
			end
			r = r(:, 1:columns(r) - numel(s.delays), :);
		end
	end

	methods (Access = private)
		% As state_space; inputs as they were some time ago are inputs, too, the last ones
		function s = wide_space(m, loads = false, at = "")
			[e, note] = equations(m, at);
			delays = struct("input", {}, "of", {}, "delay", {});
			if isfield(e.ss, "delays")
				delays = e.ss.delays;
			end
			late = {delays.input};
			column = ismember(e.ss.inputs, [m.inputs(:); late(:)]) != loads;
			delays = delays(1:end * ! loads);
			s = space_of(e.ss, column, numel(m.states));
			s.discrete = [];
			if isstruct(e.ss.discrete)
				s.discrete = space_of(e.ss.discrete, column, numel(m.states));
				s.discrete.h = e.ss.discrete.h;
			end
			s.inputs = e.ss.inputs(column);
			s.outputs = e.ss.outputs;
			s.at = note;
			s.delays = delays;
		end

		function [e, note] = equations(m, at)
			e = m.explain;
			note = "";
			if e.linear
				return
			end
			where = [at, "rest"(1:4 * isempty(at))];
			if strcmp(at, "now")
				all_of_them = [m.states; num2cell(m.state)];
				where = sprintf("%s=%.17g,", all_of_them{:})(1:end - 1);
			end
			[out, said] = plgen(m, changed(m), step_now(m), ["--explain=json --at ", quoted(where)]);
			e = jsondecode(out);
			note = regexp(said, 'linearised at [^\n]*', "match", "once");
			if isempty(at)
				warning("plgen:linearised", "%s: not linear, and %s", m.name, note);
			end
		end

		function begin(m)
			m.fresh = true;
			m.tail = [];
			m.kept = false;
			m.t = [];
		end

        % Rows as steps take them, each input as far ahead as it has to be; what comes before the first step is held.
		function u = record(m, u)
			if isscalar(m.inputs) && (isvector(u) || isempty(u)) && ! iscell(u)
				u = u(:);
			end
			need(isreal(u) && columns(u) == numel(m.inputs), ...
				sprintf("expected rows of %d numbers, the inputs", numel(m.inputs)));
			need(all(isfinite(u(:))), "the samples are not all finite");
			ahead = m.code.ahead;
			most = max(ahead);
			if most == 0 || ! (m.fresh || m.kept)
				return
			end
			whole = [m.tail; u];
			n = rows(whole) - most;
			need(n >= 0, sprintf("too few samples: the first %d come before the first step", most));
			for k = 1:most * m.fresh
				from = k - most + ahead;
				from(ahead == 0) = k;
				row = zeros(1, numel(ahead));
				for i = find(from >= 1)
					row(i) = whole(from(i), i);
				end
				m.bytes = plgen_mex("hold", m.code.id, m.bytes, row);
			end
			m.tail = whole(n + 1:end, :);
			m.kept = true;
			u = zeros(n, numel(ahead));
			for i = 1:numel(ahead)
				u(:, i) = whole(ahead(i) + (1:n), i);
			end
		end

		function tune(m, values, h)
			[bytes, status] = plgen_mex("retune", m.code.id, m.bytes, values, h);
			switch status
			case 0
				m.bytes = bytes;
				m.tuned = values;
				m.h = h;
			case 8, fail([m.name, ": the step is not above 0"]);
			case 16, fail([m.name, ": with these values a load's frequency is below 0"]);
			case 4, fail([m.name, ": with these values the mass matrix has no inverse"]);
            case 32, fail([m.name, ": these values are outside of the ranges that the spec gives, or make other " ...
                    "regions: a restitution not within 0 and 1, a gap or a force of friction below 0, " ...
					"breakpoints in another order"]);
			otherwise, fail([m.name, ": with these values the numbers of the step are not finite"]);
			end
		end

		function p = with_tuned(m, which)   % params as they were given, and these of the tunable ones
			p = m.given;
			for i = find(which)
				p.(m.tunable{i}) = m.tuned(i);
			end
		end
		function p = changed(m)
			p = with_tuned(m, m.tuned != m.code.values);
		end
		function h = step_now(m)
			h = m.h;
			if h == m.code.h
				h = m.asked;
			end
		end

		function text = trouble(m)
            words = {2, "the step has met more crossings, or needed a longer search for them, than its bound"; ...
					 1, "the step has left the finite numbers"; ...
					 4, "the step needed more substeps than its bound"; ...
					 8, "the last terms of the step are above the tolerance"; ...
					 16, "no combination of stick and slip was valid at an event"; ...
					 32, "a state has left the range that the spec gives it"; ...
					 64, "the step has ended beyond a stop"; ...
                     128, "the mass matrix is singular, or gradients of constraints depend on each other"};
			said = words(logical(bitand(double(m.status), [words{:, 1}])), 2);
			text = sprintf("%s: t = %.15g: %s", m.name, m.time, strjoin(said.', "; "));
		end

		% What plgen writes for these params, and its messages
		function [out, said] = plgen(m, given, h, extra)
			words = [" --fast", m.options, " ", extra];
			if ! isempty(h)
				words = [words, " --step ", quoted(expression(h))];
			end
			for one = fieldnames(given).'
				words = [words, " -D ", quoted([one{1}, "=", expression(given.(one{1}))])];
			end
			[status, out, said] = shell([quoted(find_plgen()), words, " -- ", quoted(m.spec)], m.text);
			need(status == 0, strtrim(said));
		end

		function build(m, params, h)
			names = fieldnames(params);
			texts = cellfun(@(n) ischar(params.(n)), names);
			expressions = rmfield(params, names(! texts));
			[c, said] = plgen(m, expressions, h, "");
			free = ! texts & ismember(names, tunable_in(c));
			fixed = rmfield(params, names(free));
			values = rmfield(params, names(! free));
			if ! isequal(fixed, expressions)
				[c, said] = plgen(m, fixed, h, "");
			end
			if ! isempty(strtrim(said))
				warning("plgen:note", "%s", strtrim(said));
			end
			was = copy(m);
			try
				take(m, open_code(c), fixed, h);
				v = m.tuned;
				for one = fieldnames(values).'
					v(strcmp(one{1}, m.tunable)) = values.(one{1});
				end
				if ! isempty(fieldnames(values))
					tune(m, v, m.h);
				end
				if ! isempty(was.code) && isequal(was.states, m.states)
					put(m, was.state, was.time);
				end
			catch why
                adopt(m, was, {"name", "states", "inputs", "outputs", "tunable", "h", "asked", "given", "tuned", ...
							   "code", "bytes"});
				rethrow(why);
			end
		end

		function adopt(m, from, names)
			for one = names
				m.(one{1}) = from.(one{1});
			end
		end

		function take(m, code, fixed, h)
			adopt(m, code, {"name", "states", "inputs", "outputs", "tunable", "h"});
			m.code = code;
			m.given = fixed;
			m.asked = h;
			m.tuned = code.values;
			m.told = [];
			reset(m);
		end
	end
end

function fail(text)
	error("plgen:error", "%s", text);
end

function need(good, text)
	if ! good
		fail(text);
	end
end

function p = named(list)
	if numel(list) == 1 && isstruct(list{1})
		p = list{1};
	elseif mod(numel(list), 2)
		fail("expected params as names and values");
	else
		p = struct(list{:});
	end
end

function text = expression(value)
	if ischar(value)
		text = value;
	else
		for digits = 15:17
			text = sprintf("%.*g", digits, value);
			if str2double(text) == value
				break
			end
		end
	end
end

function s = space_of(told, column, states)
	s.A = reshape(told.A, states, states);
	s.C = reshape(told.C, [], states);
	n = rows(s.C);
	s.B = reshape(told.B, states, [])(:, column);
	s.D = reshape(told.D, n, [])(:, column);
	s.B1 = zeros(size(s.B));
	s.D1 = zeros(size(s.D));
	if isfield(told, "B_slope")
		s.B1 = reshape(told.B_slope, states, [])(:, column);
		s.D1 = reshape(told.D_slope, n, [])(:, column);
	end
end

% ---- programs ----

function q = quoted(text)
	q = ["'", strrep(text, "'", "'\\''"), "'"];
end

% Exit status, output and messages of a command, `input` on its standard input
function [status, out, said] = shell(command, input)
	folder = tempname();
	mkdir(folder);
	clean = onCleanup(@() remove_folder(folder));
	from = "/dev/null";
	if ! isempty(input)
		from = [folder, "/in"];
		write_text(from, input);
	end
	[status, out] = system([command, " <", quoted(from), " 2>", quoted([folder, "/err"])]);
	said = fileread([folder, "/err"]);
end

function remove_folder(folder)
	confirm_recursive_rmdir(false, "local");
	rmdir(folder, "s");
end

function write_text(path, text)
	f = fopen(path, "wb");
	need(f >= 0, ["cannot write '", path, "'"]);
	fwrite(f, text);
	fclose(f);
end

function path = first_of(list, file)
	there = cellfun(@(one) ! isempty(one) && exist([one, file], "file") == 2, list);
	path = [list(there), {""}]{1};
end

function path = find_plgen()
	here = fileparts(mfilename("fullpath"));
	path = first_of({getenv("PLGEN"), [here, "/plgen"], [here, "/../../../bin/plgen"], ...
					 [here, "/../../build/plgen"]}, "");
	if isempty(path)
		[status, path] = system("command -v plgen");
		path = strtrim(path);
		need(status == 0, "there is no plgen beside plgen_model.m, nor in PATH; PLGEN names one");
	end
end

function path = find_runtime()
	here = fileparts(mfilename("fullpath"));
	there = fileparts(make_absolute_filename(find_plgen()));
	path = first_of({getenv("PLGEN_RUNTIME"), [there, "/../share/plgen/runtime"], [there, "/../runtime"], ...
					 [here, "/../runtime"], [here, "/../../runtime"]}, "/plrt.h");
	need(! isempty(path), "the runtime, plrt.h, is not there; PLGEN_RUNTIME names its folder");
end

function folder = cache()
	folder = getenv("XDG_CACHE_HOME");
	if isempty(folder) || folder(1) != "/"
		folder = [getenv("HOME"), "/.cache"];
	end
	folder = [folder, "/plgen"];
	[status, said] = system(["mkdir -p ", quoted(folder), " 2>&1"]);
	need(status == 0, strtrim(said));
end

function names = tunable_in(c)
	found = regexp(c, '_param_names\[\] = \{([^}]*)\}', "tokens", "once");
	names = [{}, regexp(["", found{:}], '"([^"]*)"', "tokens"){:}];
end

% The compiler's words, and a key of all that an object is made of: another one has another name in the cache.
function [words, runtime, key] = compiler()
	words = getenv("CC");
	if isempty(strtrim(words))
		words = "cc";
	end
	[status, version] = system([words, " --version 2>&1"]);
	need(status == 0, ["there is no compiler '", words, "'; CC names another"]);
	runtime = find_runtime();
	words = [words, " -O2 -fPIC -w ", getenv("CFLAGS"), " -I ", quoted(runtime)];
	files = sort([glob([runtime, "/*.c"]); glob([runtime, "/*.h"])]);
	texts = cellfun(@fileread, files, "UniformOutput", false);
	key = hash("sha256", [words, version, [files, texts].'{:}]);
end

% Loaded from the cache, or made: in a folder of its own, and renamed into its place.
function code = open_code(c)
	[words, runtime, key] = compiler();
	found = regexp(c, '\nextern const pl_modelf? (\w*)_model;', "tokens", "once");
	need(! isempty(found), "what plgen wrote has no descriptor");
	folder = cache();
	both = [folder, "/runtimes-", key(1:32), ".o"];
	object = [folder, "/", found{1}, "-", hash("sha256", [key, c])(1:32), ".so"];
	for attempt = 1:2                       % what a crash has left in the cache is made anew
		if exist(both, "file") != 2 || attempt == 2
			make(folder, [words, " -nostdlib -r ", quoted(runtime), "/*.c"], "", "", both);
		end
		if exist(object, "file") != 2 || attempt == 2
			make(folder, [words, " -shared -Wl,-Bsymbolic"], c, [quoted(both), " -lm"], object);
		end
		try
			code = plgen_mex("open", object, [found{1}, "_model"]);
			break
		catch why
			if attempt == 2 || ! strcmp(why.identifier, "plgen:load")
				rethrow(why);
			end
		end
	end
	code.name = found{1};
end

function make(folder, words, c, more, object)
	[~, work] = system(["mktemp -d ", quoted([folder, "/making.XXXXXX"])]);
	work = strtrim(work);
	clean = onCleanup(@() remove_folder(work));
	if ! isempty(c)
		write_text([work, "/model.c"], c);
		words = [words, " ", quoted([work, "/model.c"])];
	end
	made = quoted([work, "/model.so"]);
	[status, ~, said] = shell([words, " ", more, " -o ", made], "");
	need(status == 0, ["the compiler could not make a program of the model:\n", said]);
	system(["mv ", made, " ", quoted(object)]);
end
