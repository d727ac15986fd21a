!> A rigid tool: a surface without mesh and without dofs but those of its reference node.
module lopin_tool
   implicit none
   private
   public :: tool_type

   type, abstract :: tool_type
   end type tool_type
end module lopin_tool
