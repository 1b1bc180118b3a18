function x = numbers(name, x)
  % The numbers of an input in doubles; text, which would be read as its codes, is refused.
  if ~(isnumeric(x) || islogical(x)) || ~isreal(x)
    error('%s: expected real numbers in SI units', name);
  end
  x = double(x);
end

function x = select(c, a, b)
  % a where c holds, else b.
  whole = ones(size(c)) .* ones(size(a)) .* ones(size(b));
  x = b .* whole;
  a = a .* whole;
  c = c & (whole == 1);
  x(c) = a(c);
end

function x = root(a)
  % The square root, NaN below zero.
  a(a < 0) = NaN;
  x = sqrt(a);
end

function x = logarithm(a)
  % The natural logarithm, NaN below zero.
  a(a < 0) = NaN;
  x = log(a);
end

function x = power_of(a, b)
  % a to the power b, NaN where that is no real number.
  whole = ones(size(a)) .* ones(size(b));
  a = a .* whole;
  a(a < 0 & (b .* whole) ~= fix(b .* whole)) = NaN;
  x = a .^ b;
end

function x = copysign(a, b)
  % The size of a with the sign of b, be it that of a zero.
  minus = b < 0 | (b == 0 & 1 ./ b < 0);
  x = abs(a) .* (1 - 2 * minus);
end

function x = two_sum_error(a, b)
  % What rounding took from a + b, exactly (Knuth).
  total = a + b;
  of_b = total - a;
  x = (a - (total - of_b)) + (b - of_b);
end

function x = two_product_error(a, b)
  % What rounding took from a .* b, exactly (Dekker).
  product = a .* b;
  wide = 134217729 * a;
  a_high = wide - (wide - a);
  a_low = a - a_high;
  wide = 134217729 * b;
  b_high = wide - (wide - b);
  b_low = b - b_high;
  x = a_low .* b_low - (((product - a_high .* b_high) - a_low .* b_high) - a_high .* b_low) + 0;
end

function x = mul_add(a, b, c)
  x = a .* b + c;
end

function x = extended_only(a)
  % Whether to take a form that only twice the digits tell from the other: not here.
  x = a & false;
end

function x = rounding(a)
  % What rounding may take from a number of this size in four operations.
  x = 4.440892098500626e-16 * abs(a);
end

function x = power_of_two(a)
  % The power of two that is not below a size (Rump), from 2^-960 to 2^960.
  x = max(min(a, 2 ^ 960), 2 ^ -960);
  step = (2 ^ 53 * x + x) - 2 ^ 53 * x;
  x(step > 0) = step(step > 0);
end

function piece = lookup_piece(x, knots, way)
  % The number of the piece of a table at x; those of the way back follow. Of NaN it is the first.
  x = x .* ones(size(way));
  low = zeros(size(x));
  high = low + numel(knots);
  while any(low(:) < high(:))
    middle = floor((low + high) / 2);
    at = reshape(knots(min(middle, numel(knots) - 1) + 1), size(x));
    right = low < high & at <= x;
    high(~right) = middle(~right);
    low(right) = middle(right) + 1;
  end
  piece = low + (way < 0) .* (numel(knots) + 1);
end

function y = looked_up(x, knots, rows, piece)
  % The value of a piece of a table at x, beyond its ends too.
  [s, a, b, c, d] = row_of(x, knots, rows, piece);
  y = a + s .* (b + s .* (c + s .* d));
end

function y = looked_up_slope(x, knots, rows, piece)
  % The slope of a piece of a table at x, beyond its ends too.
  [s, a, b, c, d] = row_of(x, knots, rows, piece);
  y = b + s .* (2 * c + s .* (3 * d));
end

function [s, a, b, c, d] = row_of(x, knots, rows, piece)
  % The distance from the left knot of a piece, and its coefficients.
  at = mod(piece, numel(knots) + 1);
  s = x - reshape(knots(max(at - 1, 0) + 1), size(piece));
  a = reshape(rows(4 * piece + 1), size(piece));
  b = reshape(rows(4 * piece + 2), size(piece));
  c = reshape(rows(4 * piece + 3), size(piece));
  d = reshape(rows(4 * piece + 4), size(piece));
end

function x = rotated_sin(sine, cosine, quarters)
  % The sine of an angle and whole quarter turns, from the angle's own.
  x = select(mod(quarters, 2) == 1, cosine, sine);
  x = select(mod(quarters, 4) >= 2, -x, x);
end

function x = rotated_cos(sine, cosine, quarters)
  % The cosine of an angle and whole quarter turns, from the angle's own.
  x = select(mod(quarters, 2) == 1, sine, cosine);
  x = select(mod(quarters + 1, 4) >= 2, -x, x);
end
