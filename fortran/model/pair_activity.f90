!> Which contact pairs act in a step: `*MODEL CHANGE` takes pairs away and puts them back,
!> `*CHANGE SURFACE BEHAVIOR` lets one take the place of another.
module lopin_pair_activity
   use lopin_model, only : model_type, output_type
   implicit none
   private
   public :: active_pairs, pairs_change, asks_pair, is_named

contains

   !> Pairs that act in a step. With `change_step` later than `step`, those of them that *MODEL
   !> CHANGE leaves then: a pair that another one replaces is let go of by nobody.
   pure function active_pairs(model, step, change_step) result(active)
      type(model_type), intent(in) :: model
      integer, intent(in) :: step
      integer, intent(in), optional :: change_step   !! last step whose *MODEL CHANGE counts
      logical :: active(size(model%pair))
      integer :: s, i, last

      active = .true.
      last = step
      if (present(change_step)) last = change_step
      do s = 1, last
         if (.not. allocated(model%step(s)%pair_change)) cycle
         do i = 1, size(model%step(s)%pair_change)
            active(model%step(s)%pair_change(i)%pair) = model%step(s)%pair_change(i)%active
         end do
      end do
      do i = 1, size(model%pair)
         if (model%pair(i)%before > 0) active(i) = active(model%pair(i)%before)
      end do
      active = active .and. step >= model%pair%first_step .and. step <= model%pair%last_step
   end function active_pairs

   !> A request for contact output is of a pair: of all of them if it names no surface.
   pure logical function asks_pair(model, output, p)
      type(model_type), intent(in) :: model
      type(output_type), intent(in) :: output
      integer, intent(in) :: p                 !! pair

      associate (pair => model%pair(p))
         asks_pair = (output%slave == 0 .or. is_named(model, output%slave, pair%slave)) &
            & .and. (output%master == 0 .or. is_named(model, output%master, pair%master))
      end associate
   end function asks_pair

   !> Two surfaces have one name, which may stand for one of faces and for one of nodes.
   pure logical function is_named(model, asked, surface)
      type(model_type), intent(in) :: model
      integer, intent(in) :: asked, surface    !! 0: none, which has no name

      is_named = asked > 0 .and. surface > 0
      if (is_named) is_named = model%surface(asked)%name == model%surface(surface)%name
   end function is_named

   !> The deck changes pairs between steps.
   pure logical function pairs_change(model)
      type(model_type), intent(in) :: model
      integer :: s

      pairs_change = any(model%pair%before > 0)
      do s = 1, size(model%step)
         pairs_change = pairs_change .or. size(model%step(s)%pair_change) > 0
      end do
   end function pairs_change
end module lopin_pair_activity
