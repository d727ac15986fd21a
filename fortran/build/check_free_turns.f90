!> Rigid bodies that a deck moves and that are free to turn: right for a roller, forgotten for a
!> ram.
module lopin_check_free_turns
   use lopin_error, only : severity
   use lopin_model, only : model_type, kind_of
   use lopin_text, only : to_text
   implicit none
   private
   public :: check_free_turns

   character(len=*), parameter :: axes = 'xyz'

contains

   subroutine check_free_turns(model)
      type(model_type), intent(inout) :: model
      integer :: i, k, first, node
      logical :: driven(6), free(3)
      character(len=:), allocatable :: about, dofs

      if (model%kind == kind_of%axisymmetric) return
      first = merge(1, 3, model%mesh%ndim == 3)
      do i = 1, size(model%rigid_body)
         associate (body => model%rigid_body(i))
            driven = .false.
            call find_driven(model, body%reference, driven)
            if (.not. any(driven(:model%mesh%ndim))) cycle
            node = body%reference
            if (body%rotation > 0) then
               node = body%rotation
               driven(4:6) = .false.
               call find_driven(model, node, driven, 3)
            end if
            free = .false.
            free(first:) = .not. driven(3 + first:)
            if (.not. any(free)) cycle
            about = ''
            dofs = ''
            do k = first, 3
               if (.not. free(k)) cycle
               if (len(about) > 0) about = about//' or '
               about = about//axes(k:k)
               if (len(dofs) > 0) dofs = dofs//' and '
               dofs = dofs//to_text(k + merge(0, 3, body%rotation > 0))
            end do
            if (count(free) > 1) then
               dofs = 'dofs '//dofs
            else
               dofs = 'dof '//dofs
            end if
            call model%log%say(severity%note, 'N0305', 'rigid body '//body%name// &
               & ' is moved and free to turn about '//about//': nothing prescribes '// &
               & dofs//' of node '//to_text(model%mesh%node_label(node)), body%at, &
               & help='*BOUNDARY on these dofs if it should not turn; else contact and '// &
               & 'friction turn it')
         end associate
      end do
   end subroutine check_free_turns

   !> Dofs of a node that some step prescribes or loads, that an equation or a spring holds.
   subroutine find_driven(model, node, driven, before)
      type(model_type), intent(in) :: model
      integer, intent(in) :: node
      logical, intent(inout) :: driven(6)
      integer, intent(in), optional :: before  !! dofs of the body before those of the node
      integer :: s, i, shift

      shift = 0
      if (present(before)) shift = before
      do s = 1, size(model%step)
         associate (step => model%step(s))
            do i = 1, size(step%prescribed)
               if (step%prescribed(i)%node == node) call take(step%prescribed(i)%dof)
            end do
            do i = 1, size(step%point_load)
               if (step%point_load(i)%node == node) call take(step%point_load(i)%dof)
            end do
         end associate
      end do
      do i = 1, size(model%equation)
         do s = 1, size(model%equation(i)%node)
            if (model%equation(i)%node(s) == node) call take(model%equation(i)%dof(s))
         end do
      end do
      do i = 1, size(model%spring)
         if (any(model%spring(i)%node == node)) driven = .true.
      end do

   contains

      subroutine take(dof)
         integer, intent(in) :: dof
         if (dof + shift >= 1 .and. dof + shift <= 6) driven(dof + shift) = .true.
      end subroutine take
   end subroutine find_driven
end module lopin_check_free_turns
