@COMMENT@
type Values = number | readonly number[] | Float64Array;

export interface Inputs<T = Values> {
  @INPUTS@
}

export interface Outputs<T> {
  @OUTPUTS@
}

export const INPUTS: readonly @NAMES@;
export const OUTPUTS: readonly @RESULTS@;
export const UNITS: Readonly<Record<string, string>>;

@FUNCTIONS@

export function evaluate(inputs: Inputs<number>): Outputs<number>;
export function evaluate(inputs: Inputs): Outputs<Float64Array>;
