%{
@module_start
@module_name Gps
@Sense NotifyWhenReady,
  NotifyOnChange
@Output Fix
%}
function fix = gps()
end
% @module_end

%{
% @module_start
% @module_name Compass
% @Sense NotifyAtFrequency 5
function heading = turn()
end
% @module_end
%}

%{
%{
Block comments nest.
@module_start
%}
% @module_start
%}

% % @module_start
%{ @module_start
%{ % @module_start %}
