!> Degrees of freedom that one step prescribes twice with different values.
!>
!> The last line counts, as in CalculiX; which one was meant is for the user to say. Another value
!> in a later step is how steps are written, and equal values are harmless: of both nothing is said.
module lopin_prescribed_twice
   use lopin_kinds, only : wp
   use lopin_error, only : severity
   use lopin_text, only : to_text
   use lopin_model, only : model_type, prescribed_type
   implicit none
   private
   public :: clash_list_type, differ, note_clash, warn_of_clashes

   !> Two lines of a deck that prescribe the same dofs differently.
   type :: clash_type
      type(prescribed_type) :: overridden, counts   !! of the first dof
      integer :: number = 0                         !! of dofs
   end type clash_type

   type :: clash_list_type
      type(clash_type), allocatable :: item(:)
   end type clash_list_type

contains

   !> Two prescriptions of one dof move it differently.
   pure logical function differ(a, b)
      type(prescribed_type), intent(in) :: a, b

      differ = abs(a%value - b%value) > 0.0_wp
      if (differ .or. .not. abs(a%value) > 0.0_wp) return
      differ = a%amplitude /= b%amplitude .or. (a%velocity .neqv. b%velocity)
   end function differ

   !> Keep a clash; those of the same two lines are one.
   pure subroutine note_clash(self, overridden, counts)
      type(clash_list_type), intent(inout) :: self
      type(prescribed_type), intent(in) :: overridden, counts
      integer :: i

      if (.not. allocated(self%item)) allocate (self%item(0))
      do i = 1, size(self%item)
         if (self%item(i)%overridden%at%line /= overridden%at%line) cycle
         if (self%item(i)%overridden%at%file /= overridden%at%file) cycle
         if (self%item(i)%counts%at%line /= counts%at%line) cycle
         if (self%item(i)%counts%at%file /= counts%at%file) cycle
         self%item(i)%number = self%item(i)%number + 1
         return
      end do
      self%item = [self%item, clash_type(overridden, counts, 1)]
   end subroutine note_clash

   !> One warning for every two lines, and the list is empty again.
   subroutine warn_of_clashes(self, model, step)
      type(clash_list_type), intent(inout) :: self
      type(model_type), intent(inout) :: model
      integer, intent(in) :: step              !! 0: the model part
      character(len=:), allocatable :: more, place
      integer :: i

      if (.not. allocated(self%item)) return
      place = 'step '//to_text(step)
      if (step == 0) place = 'the model part'
      do i = 1, size(self%item)
         associate (first => self%item(i)%overridden, last => self%item(i)%counts)
            more = ''
            if (self%item(i)%number > 1) more = ' (and '//to_text(self%item(i)%number - 1)// &
               & ' more dofs)'
            call model%log%say(severity%warning, 'W0404', 'dof '//to_text(last%dof)// &
               & ' of node '//to_text(model%mesh%node_label(last%node))//more// &
               & ' is prescribed twice in '//place//', with two values: '//shown(model, first)// &
               & ' in line '//to_text(first%at%line)//' and '//shown(model, last)//' in line '// &
               & to_text(last%at%line)//'; the last counts', last%at, &
               & help='remove one of the lines, or take the node out of one of the sets')
         end associate
      end do
      deallocate (self%item)
   end subroutine warn_of_clashes

   function shown(model, item) result(text)
      type(model_type), intent(in) :: model
      type(prescribed_type), intent(in) :: item
      character(len=:), allocatable :: text

      text = to_text(item%value, 6)
      if (item%velocity) text = 'a velocity of '//text
      if (item%amplitude > 0) text = text//' times '//model%amplitude(item%amplitude)%name
   end function shown
end module lopin_prescribed_twice
