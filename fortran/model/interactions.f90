!> Interactions of a model: the default, and the addition of another.
module lopin_interactions
   use lopin_enforcement_factory, only : new_enforcement
   use lopin_model, only : model_type, interaction_type
   implicit none
   private
   public :: new_interaction, add_interaction

contains

   !> Exact contact without friction.
   subroutine new_interaction(self)
      type(interaction_type), intent(out) :: self
      call new_enforcement(self%method, 'lagrange')
   end subroutine new_interaction

   !> One by one: compilers lose polymorphic components in array constructors.
   subroutine add_interaction(model, interaction)
      type(model_type), intent(inout) :: model
      type(interaction_type), intent(in) :: interaction
      type(interaction_type), allocatable :: grown(:)
      integer :: i, n

      n = size(model%interaction)
      allocate (grown(n + 1))
      do i = 1, n
         grown(i) = model%interaction(i)
      end do
      grown(n + 1) = interaction
      call move_alloc(grown, model%interaction)
   end subroutine add_interaction
end module lopin_interactions
