!> Motions that nothing holds, in words.
module lopin_body_words
   use lopin_kinds, only : wp
   use lopin_model, only : model_type, kind_of
   use lopin_bodies, only : bodies_type
   implicit none
   private
   public :: describe_motion

contains

   !> A motion in words: which body or tool, along or about which axis.
   function describe_motion(self, model, q) result(text)
      type(bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      real(wp), intent(in) :: q(:)             !! (nq)
      character(len=:), allocatable :: text
      real(wp), allocatable :: a(:)
      real(wp) :: part(6)
      integer :: body, best, i, k

      a = matmul(self%amplitude, q)
      if (.not. any(abs(a) > 0.0_wp)) a = self%amplitude(:, 1)
      best = 0
      part = 0.0_wp
      do body = 1, self%nbody
         associate (mine => a(self%nmode*(body - 1) + 1:self%nmode*body))
            if (maxval(abs(mine)) <= maxval(abs(part))*(1.0_wp + 1.0e-6_wp)) cycle
            best = body
            part = 0.0_wp
            select case (self%nmode)
            case (1)
               part(2) = mine(1)
            case (3)
               part([1, 2, 6]) = mine
            case (6)
               part = mine
            end select
         end associate
      end do
      text = body_name(self, model, best)
      do i = 1, size(self%column, 2)
         do k = 1, 6
            if (self%column(k, i) == 0) cycle
            if (abs(a(self%column(k, i))) <= maxval(abs(part))*(1.0_wp + 1.0e-6_wp)) cycle
            part = 0.0_wp
            part(k) = a(self%column(k, i))
            text = 'rigid body '//model%rigid_body(i)%name
         end do
      end do
      text = text//' can '//motion_words(part, model%kind == kind_of%axisymmetric)
   end function describe_motion

   !> The smallest element set that holds the body, or its first element.
   function body_name(self, model, body) result(text)
      type(bodies_type), intent(in) :: self
      type(model_type), intent(in) :: model
      integer, intent(in) :: body
      character(len=:), allocatable :: text
      character(len=12) :: digits
      integer :: i, e, members, best

      text = 'a node of *EQUATION or *PRE-TENSION SECTION'
      if (body == 0) return
      members = 0
      do e = 1, model%mesh%nelement
         if (self%body(model%mesh%conn(1, e)) /= body .or. model%mesh%section(e) == 0) cycle
         if (members == 0) then
            write (digits, '(i0)') model%mesh%element_label(e)
            text = 'the body of element '//trim(digits)
         end if
         members = members + 1
      end do
      best = huge(1)
      do i = 1, size(model%mesh%elset)
         associate (set => model%mesh%elset(i)%member)
            if (size(set) < members .or. size(set) >= best) cycle
            if (count(self%body(model%mesh%conn(1, set)) == body) < members) cycle
            best = size(set)
            text = 'body '//model%mesh%elset(i)%name
         end associate
      end do
   end function body_name

   function motion_words(part, axisymmetric) result(text)
      real(wp), intent(in) :: part(6)
      logical, intent(in) :: axisymmetric
      character(len=:), allocatable :: text
      character(len=*), parameter :: axis = 'xyz'
      integer :: k

      text = ''
      do k = 1, 6
         if (abs(part(k)) < 0.1_wp*maxval(abs(part))) cycle
         if (len(text) > 0) text = text//' and '
         if (k <= 3) then
            text = text//'move along '//axis(k:k)
            if (axisymmetric) text = 'move along the axis (z)'
         else
            text = text//'turn about '//axis(k - 3:k - 3)
         end if
      end do
   end function motion_words
end module lopin_body_words
