%{
@module_start
@module_name Matlab
@Tag safety_critical
@Property latency_ms 7
@Sense NotifyWhenReady
@Output Image
%}
function image = matlab()
end
% @module_end
